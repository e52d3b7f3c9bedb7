// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/lens_stream.h"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

#include "hal/base/guarded.h"
#include "hal/base/log.h"

namespace mixrig::live {

Result<std::unique_ptr<LensStream>> LensStream::open(const RigConfig& config,
                                                     const Devices& devices, const Clock& clock) {
  if (config.lens_uri.empty()) return std::unique_ptr<LensStream>();
  assert(devices.lens.open != nullptr);  // open_devices() found it
  auto receiver = devices.lens.open(config.lens_uri);
  if (!receiver)
    return Error{receiver.error().code,
                 config.file.string() + ": lens.uri: " + to_line(receiver.error())};
  return std::make_unique<LensStream>(*std::move(receiver), config.lens_delay, clock);
}

LensStream::LensStream(std::unique_ptr<LensReceiver> receiver, Duration delay, const Clock& clock)
    : receiver_(std::move(receiver)),
      delay_(delay),
      clock_(clock),
      thread_(guarded_thread(
          "receiving", [this] { return listen(); },
          [](const Error& error) {
            log_warning("live", "lens: " + to_line(error) + ": no more lens values are received");
          })) {}

LensStream::~LensStream() {
  stop_ = true;
  thread_.join();
  if (const std::string trouble = receiver_->trouble(); !trouble.empty())
    log_warning("live", "lens: " + trouble);
}

Result<void> LensStream::listen() {
  constexpr Duration kLook = std::chrono::milliseconds(50);  // how often stop_ is checked
  while (!stop_) {
    MIXRIG_ASSIGN(const auto encoders, receiver_->next(kLook));
    if (encoders) keep(*encoders);
  }
  return {};
}

void LensStream::keep(const geometry::LensEncoders& encoders) {
  const capture::LensSample sample{clock_.now() - delay_, encoders};
  const std::lock_guard lock(mutex_);
  // No newer than the last sample.
  if (count_ > 0 && sample.time <= samples_[count_ - 1].time) return;
  if (count_ == kKept) std::move(samples_.begin() + 1, samples_.end(), samples_.begin());
  count_ = std::min(count_ + 1, kKept);
  samples_[count_ - 1] = sample;
}

std::optional<geometry::LensEncoders> LensStream::at(HostTime mid_exposure) const {
  const std::lock_guard lock(mutex_);
  return capture::lens_at(std::span(samples_).first(count_), mid_exposure);
}

}  // namespace mixrig::live
