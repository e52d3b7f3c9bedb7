// SPDX-License-Identifier: Apache-2.0
// When a software trigger must switch which line: the schedule, without any line.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/trigger.h"

namespace mixrig::device {

inline constexpr int kSoftwareChannels = 8;
inline constexpr Duration kSoftwareTick = std::chrono::milliseconds(10);

/// Edges of all channels in order of time. One thread.
class SoftwareSchedule {
 public:
  struct Edge {
    HostTime at{};
    int channel = -1;  ///< -1: the master tick itself
    bool active = false;
    std::uint64_t tick = 0;  ///< valid for the master
  };
  /// Errors: kUsage where the pulse does not fit between two of its ticks.
  Result<void> configure(int channel, const TriggerChannel& settings);
  const TriggerChannel& channel(int index) const {
    return channels_[static_cast<std::size_t>(index)];
  }
  /// Tick 0 is at `begin`.
  void start(HostTime begin);
  /// The next edge; the schedule moves on by it.
  Edge next();
  /// Lines whose pulse begins in tick `tick`.
  std::uint32_t fired(std::uint64_t tick) const;

 private:
  struct Line {
    HostTime at{};
    bool active = false;  ///< what the edge at `at` switches to
  };
  std::array<TriggerChannel, kSoftwareChannels> channels_{};
  std::array<Line, kSoftwareChannels> lines_{};
  HostTime begin_{};
  std::uint64_t tick_ = 0;
};

}  // namespace mixrig::device
