// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/lens_stream.h"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"

namespace mixrig::live {

Result<std::unique_ptr<LensStream>> LensStream::open(const RigConfig& config, const Clock& clock) {
  if (config.lens_uri.empty()) return std::unique_ptr<LensStream>();
  MIXRIG_ASSIGN(const stream::ListenAddress address, stream::parse_freed_address(config.lens_uri));
  auto receiver = stream::FreeDReceiver::open(address);
  if (!receiver)
    return Error{receiver.error().code,
                 config.file.string() + ": lens.uri: " + receiver.error().context};
  return std::make_unique<LensStream>(*std::move(receiver), config.lens_delay, clock);
}

LensStream::LensStream(stream::FreeDReceiver receiver, Duration delay, const Clock& clock)
    : receiver_(std::move(receiver)), delay_(delay), clock_(clock), thread_([this] { listen(); }) {}

LensStream::~LensStream() {
  stop_ = true;
  thread_.join();
  const stream::StreamCounts& counts = receiver_.counts();
  if (counts.packets == 0 || counts.malformed > 0)
    log_warning("live", fmt::format("lens: {} packets of FreeD came, {} could not be read, {} were "
                                    "of another camera",
                                    counts.packets, counts.malformed, counts.foreign));
}

void LensStream::listen() {
  constexpr Duration kLook = std::chrono::milliseconds(50);  // at stop_
  while (!stop_) {
    const auto packet = receiver_.next(kLook);
    if (!packet) {
      log_warning("live", "lens: " + packet.error().context + ": its values end here");
      return;
    }
    if (*packet) keep(**packet);
  }
}

void LensStream::keep(const stream::FreeDPacket& packet) {
  const capture::LensSample sample{
      clock_.now() - delay_, {static_cast<double>(packet.zoom), static_cast<double>(packet.focus)}};
  const std::lock_guard lock(mutex_);
  if (count_ > 0 && sample.time <= samples_[count_ - 1].time) return;  // two at one time
  if (count_ == kKept) std::move(samples_.begin() + 1, samples_.end(), samples_.begin());
  count_ = std::min(count_ + 1, kKept);
  samples_[count_ - 1] = sample;
}

std::optional<geometry::LensEncoders> LensStream::at(HostTime mid_exposure) const {
  const std::lock_guard lock(mutex_);
  return capture::lens_at(std::span(samples_).first(count_), mid_exposure);
}

}  // namespace mixrig::live
