// SPDX-License-Identifier: Apache-2.0
// A trigger master whose ticks the test produces.
#pragma once

#include <array>
#include <condition_variable>
#include <mutex>

#include "hal/device/trigger.h"

namespace mixrig::fake {

/// A trigger master for tests. Its clock counts from its construction or its last reset. Any thread
/// may call its methods.
class FakeTrigger final : public device::TriggerMaster {
 public:
  explicit FakeTrigger(Clock& clock);
  const device::TriggerInfo& info() const override { return info_; }
  Result<device::TriggerStatus> status() override;
  Result<void> configure(int channel, const device::TriggerChannel& settings) override;
  Result<void> start() override;
  Result<void> stop() override;
  Result<std::size_t> read_ticks(std::span<device::TriggerTick> out, Duration timeout) override;

  /// Makes the next tick happen now if the trigger runs; returns its number.
  std::uint64_t tick();
  /// The number of the first tick after the next starts.
  void number_from(std::uint64_t first);
  /// Resets the controller, as a brown-out does: it is idle, and tick numbers restart.
  void reset();
  bool running() const;
  /// Unplugs its cable: it continues to fire, but reports and answers are lost.
  void set_silent(bool silent);
  /// Number of reported ticks that were not read yet.
  std::size_t waiting() const;
  /// Waits until start() was called for the `count`-th time.
  bool wait_for_start(int count, Duration timeout);

 private:
  static constexpr int kChannels = 16;
  Result<void> answer() const;
  McuTime mcu_now() const { return McuTime(clock_.now() - booted_); }

  Clock& clock_;
  HostTime booted_;
  device::TriggerInfo info_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  device::TickRing ticks_;
  std::array<device::TriggerChannel, kChannels> channels_{};
  device::TriggerState state_ = device::TriggerState::kIdle;
  bool silent_ = false;
  std::uint64_t first_ = 0, next_ = 0;
  int starts_ = 0;
};

}  // namespace mixrig::fake
