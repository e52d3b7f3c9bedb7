// SPDX-License-Identifier: Apache-2.0
#include "hal/device/stream_count.h"

#include <utility>

#include "hal/base/guarded.h"
#include "hal/base/log.h"

namespace mixrig::device {
namespace {

constexpr Duration kFindAgain = std::chrono::milliseconds(250);

}  // namespace

void log_end_of_driver(const Error& error) {
  log_warning("device", error.context + ": no more frames come");
}

std::uint64_t CounterLine::at(std::uint64_t raw) {
  constexpr std::uint64_t kNear = 1000;  // frames lost at the wrap, at most
  for (const std::uint64_t period : {std::uint64_t{0xFFFF}, std::uint64_t{1} << 32}) {
    const auto before = [&](std::uint64_t v) { return v <= period && v + kNear > period; };
    if (before(last_) && raw <= kNear) turns_ += period;
    if (before(raw) && last_ <= kNear && turns_ >= period) return turns_ - period + raw;  // late
  }
  last_ = raw;
  return turns_ + raw;
}

void StreamCount::come_back() {
  health.state = DeviceState::kStreaming;
  ++health.returns;
  begin();
  restarted_ = true;
}

bool StreamCount::count(Frame& frame, bool has_buffer) {
  frame.sequence = line_.at(frame.sequence);
  if (last_ && frame.sequence > *last_ + 1) {
    health.lost += frame.sequence - *last_ - 1;
    frame.flags |= kFrameAfterGap;
  }
  last_ = frame.sequence;
  if (!has_buffer) {
    ++health.overrun;
    return false;
  }
  if ((frame.flags & kFrameIncomplete) != 0) ++health.incomplete;
  if (std::exchange(restarted_, false)) frame.flags |= kFrameRestarted;
  ++health.frames;
  return true;
}

void DriverThread::start(std::function<void()> work) {
  stop_ = false;
  thread_ = guarded_thread("driver", std::move(work), log_end_of_driver);
}

bool DriverThread::stop() {
  stop_ = true;
  if (!thread_.joinable()) return false;
  thread_.join();
  return true;
}

bool DriverThread::find_again(const char* who, const std::string& uri,
                              const std::function<bool()>& find) {
  log_warning(who, uri + ": lost; looking for it");
  while (!stop_) {
    clock_.sleep_until(clock_.now() + kFindAgain);
    if (!find()) continue;
    log_warning(who, uri + ": is back");
    return true;
  }
  return false;
}

}  // namespace mixrig::device
