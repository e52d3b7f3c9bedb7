// SPDX-License-Identifier: Apache-2.0
// A trigger master without a trigger board: a thread switches lines as punctually as the scheduler
// allows.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/trigger.h"

namespace mixrig::device {

inline constexpr int kSoftwareChannels = 8;
inline constexpr Duration kSoftwareTick = std::chrono::milliseconds(10);

/// Computes when software must switch which line. For one thread.
class SoftwareSchedule {
 public:
  struct Edge {
    HostTime at{};
    int channel = -1;  ///< -1: the master tick itself
    bool active = false;
    std::uint64_t tick = 0;  ///< valid for a master tick
  };
  /// `settings` must have passed check_channel().
  void configure(int channel, const TriggerChannel& settings);
  const TriggerChannel& channel(int index) const {
    return channels_[static_cast<std::size_t>(index)];
  }
  /// Starts the schedule with tick 0 at `begin`.
  void start(HostTime begin);
  /// Returns the next edge and advances the schedule past it.
  Edge next();
  /// Returns the mask of lines whose pulse begins in tick `tick`.
  std::uint32_t fired(std::uint64_t tick) const;

 private:
  struct Line {
    HostTime at{};
    bool active = false;  ///< state after the edge at `at`
  };
  std::array<TriggerChannel, kSoftwareChannels> channels_{};
  std::array<Line, kSoftwareChannels> lines_{};
  HostTime begin_{};
  std::uint64_t tick_ = 0;
};

/// Output lines that software drives. For one thread at a time.
class LineOutputs {
 public:
  virtual ~LineOutputs() = default;
  virtual int count() const = 0;
  /// Sets the level of a line. The first call for a line makes it an output. Errors: kDevice.
  virtual Result<void> drive(int line, bool high) = 0;
};

/// A TriggerMaster on output lines, with the host's clock. `late_max` of its status is the jitter:
/// check whether it is small enough.
class SoftwareTrigger final : public TriggerMaster {
 public:
  /// Uses the first kSoftwareChannels of `lines`. `clock` must outlive it.
  SoftwareTrigger(std::unique_ptr<LineOutputs> lines, Clock& clock, std::string uri);
  ~SoftwareTrigger() override { (void)stop(); }
  SoftwareTrigger(const SoftwareTrigger&) = delete;
  SoftwareTrigger& operator=(const SoftwareTrigger&) = delete;

  const TriggerInfo& info() const override { return info_; }
  Result<TriggerStatus> status() override;
  Result<void> configure(int channel, const TriggerChannel& settings) override;
  Result<void> start() override;
  Result<void> stop() override;
  Result<std::size_t> read_ticks(std::span<TriggerTick> out, Duration timeout) override;

 private:
  void work();
  void record(const SoftwareSchedule::Edge& edge, HostTime at, bool failed);
  Result<void> rest_lines();

  std::unique_ptr<LineOutputs> lines_;
  Clock& clock_;
  TriggerInfo info_;
  SoftwareSchedule schedule_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::condition_variable ticked_;
  TickRing ticks_;
  std::uint64_t tick_ = 0, failed_ = 0;
  Duration late_max_{};
};

}  // namespace mixrig::device
