// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/fake_trigger.h"

namespace mixrig::fake {

FakeTrigger::FakeTrigger(Clock& clock) : clock_(clock), booted_(clock.now()) {
  info_.uri = "fake:trigger";
  info_.version = "fake";
  info_.clock = "of the test";
  info_.channels = kChannels;
  info_.max_divider = 600;
  info_.tick = std::chrono::milliseconds(10);
  info_.slot = std::chrono::microseconds(100);
}

/// Returns the error of a silent trigger. Call with the lock held.
Result<void> FakeTrigger::answer() const {
  if (!silent_) return {};
  return Error{ErrorCode::kTimeout, "fake:trigger: no answer"};
}

Result<device::TriggerStatus> FakeTrigger::status() {
  const std::lock_guard lock(mutex_);
  MIXRIG_TRY(answer());
  device::TriggerStatus status;
  status.state = state_;
  for (unsigned i = 0; i < kChannels; ++i)
    if (channels_[i].divider > 0) status.enabled |= 1U << i;
  status.tick = next_;
  status.asked = status.answered = clock_.now();
  status.now = McuTime(status.asked - booted_);
  return status;
}

Result<void> FakeTrigger::configure(int channel, const device::TriggerChannel& settings) {
  MIXRIG_TRY(check_channel(info_, channel, settings));
  const std::lock_guard lock(mutex_);
  MIXRIG_TRY(answer());
  if (state_ == device::TriggerState::kRunning)
    return Error{ErrorCode::kDevice, "fake:trigger: runs; stop it first"};
  channels_[static_cast<std::size_t>(channel)] = settings;
  return {};
}

Result<void> FakeTrigger::start() {
  const std::lock_guard lock(mutex_);
  MIXRIG_TRY(answer());
  state_ = device::TriggerState::kRunning;
  next_ = first_;
  ticks_.clear();
  ++starts_;
  changed_.notify_all();
  return {};
}

Result<void> FakeTrigger::stop() {
  const std::lock_guard lock(mutex_);
  MIXRIG_TRY(answer());
  state_ = device::TriggerState::kIdle;
  return {};
}

Result<std::size_t> FakeTrigger::read_ticks(std::span<device::TriggerTick> out, Duration timeout) {
  std::unique_lock lock(mutex_);
  MIXRIG_TRY(answer());
  changed_.wait_for(lock, timeout, [this] { return !ticks_.empty(); });
  return ticks_.take(out);
}

std::uint64_t FakeTrigger::tick() {
  const std::lock_guard lock(mutex_);
  if (state_ != device::TriggerState::kRunning) return next_;
  std::uint32_t fired = 0;
  for (unsigned i = 0; i < kChannels; ++i) {
    const device::TriggerChannel& channel = channels_[i];
    const auto first = static_cast<std::uint64_t>(channel.phase / info_.tick);
    if (channel.divider > 0 && next_ >= first &&
        (next_ - first) % static_cast<std::uint64_t>(channel.divider) == 0)
      fired |= 1U << i;
  }
  if (!silent_) (void)ticks_.push({next_, mcu_now(), fired});
  changed_.notify_all();
  return next_++;
}

void FakeTrigger::number_from(std::uint64_t first) {
  const std::lock_guard lock(mutex_);
  first_ = first;
}

void FakeTrigger::reset() {
  const std::lock_guard lock(mutex_);
  state_ = device::TriggerState::kIdle;
  booted_ = clock_.now();
  ticks_.clear();
}

bool FakeTrigger::running() const {
  const std::lock_guard lock(mutex_);
  return state_ == device::TriggerState::kRunning;
}

void FakeTrigger::set_silent(bool silent) {
  const std::lock_guard lock(mutex_);
  silent_ = silent;
}

std::size_t FakeTrigger::waiting() const {
  const std::lock_guard lock(mutex_);
  return ticks_.size();
}

bool FakeTrigger::wait_for_start(int count, Duration timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return starts_ >= count; });
}

}  // namespace mixrig::fake
