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

Result<device::TriggerStatus> FakeTrigger::status() {
  const std::lock_guard lock(mutex_);
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
  if (state_ == device::TriggerState::kRunning)
    return Error{ErrorCode::kDevice, "fake:trigger: runs; stop it first"};
  channels_[static_cast<std::size_t>(channel)] = settings;
  return {};
}

Result<void> FakeTrigger::start() {
  const std::lock_guard lock(mutex_);
  state_ = device::TriggerState::kRunning;
  next_ = 0;
  count_ = 0;
  ++starts_;
  changed_.notify_all();
  return {};
}

Result<void> FakeTrigger::stop() {
  const std::lock_guard lock(mutex_);
  state_ = device::TriggerState::kIdle;
  return {};
}

Result<std::size_t> FakeTrigger::read_ticks(std::span<device::TriggerTick> out, Duration timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return count_ > 0; });
  std::size_t count = 0;
  for (; count < out.size() && count_ > 0; ++count, --count_) {
    out[count] = ticks_[first_];
    first_ = (first_ + 1) % kKept;
  }
  return count;
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
  if (count_ == kKept) {
    first_ = (first_ + 1) % kKept;
    --count_;
  }
  ticks_[(first_ + count_++) % kKept] = {next_, mcu_now(), fired};
  changed_.notify_all();
  return next_++;
}

void FakeTrigger::reset() {
  const std::lock_guard lock(mutex_);
  state_ = device::TriggerState::kIdle;
  booted_ = clock_.now();
  count_ = 0;
}

bool FakeTrigger::running() const {
  const std::lock_guard lock(mutex_);
  return state_ == device::TriggerState::kRunning;
}

std::size_t FakeTrigger::waiting() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

bool FakeTrigger::wait_for_start(int count, Duration timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return starts_ >= count; });
}

}  // namespace mixrig::fake
