// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/fake_trigger.h"

namespace mixrig::fake {

Result<device::TriggerStatus> FakeTrigger::status() {
  const std::lock_guard lock(mutex_);
  device::TriggerStatus status;
  status.state = state_;
  status.tick = next_;
  status.asked = status.answered = clock_.now();
  status.now = McuTime(status.asked.time_since_epoch());
  return status;
}

Result<void> FakeTrigger::configure(int, const device::TriggerChannel&) {
  const std::lock_guard lock(mutex_);
  if (state_ == device::TriggerState::kRunning)
    return Error{ErrorCode::kDevice, "fake:trigger: runs; stop it first"};
  return {};
}

Result<void> FakeTrigger::start() {
  const std::lock_guard lock(mutex_);
  state_ = device::TriggerState::kRunning;
  next_ = 0;
  ticks_.clear();
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
  changed_.wait_for(lock, timeout, [this] { return !ticks_.empty(); });
  std::size_t count = 0;
  for (; count < out.size() && !ticks_.empty(); ++count) {
    out[count] = ticks_.front();
    ticks_.pop_front();
  }
  return count;
}

std::uint64_t FakeTrigger::tick() {
  const std::lock_guard lock(mutex_);
  ticks_.push_back({next_, McuTime(clock_.now().time_since_epoch()), 1});
  changed_.notify_all();
  return next_++;
}

void FakeTrigger::reset() {
  const std::lock_guard lock(mutex_);
  state_ = device::TriggerState::kIdle;
  ticks_.clear();
}

bool FakeTrigger::running() const {
  const std::lock_guard lock(mutex_);
  return state_ == device::TriggerState::kRunning;
}

bool FakeTrigger::wait_for_start(int count, Duration timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return starts_ >= count; });
}

}  // namespace mixrig::fake
