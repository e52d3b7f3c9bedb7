// SPDX-License-Identifier: Apache-2.0
// The machine's system clock: its state, and its two time scales.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "hal/base/clock.h"

namespace mixrig {

using UtcTime = ClockDomain<struct UtcTag>::time_point;  ///< system clock, since 1970
using TaiTime = ClockDomain<struct TaiTag>::time_point;  ///< PTP's time, since 1970

/// TAI - UTC as the kernel has it, whole seconds; 37 s, as since 2017, where it was never told. Any
/// thread.
Duration tai_minus_utc();

inline TaiTime tai_from(UtcTime time, Duration tai_minus_utc) {
  return TaiTime(time.time_since_epoch() + tai_minus_utc);
}
inline UtcTime utc_from(TaiTime time, Duration tai_minus_utc) {
  return UtcTime(time.time_since_epoch() - tai_minus_utc);
}

/// Whether the kernel reports that PTP or NTP keeps the system clock synchronized, as `timedatectl`
/// shows. Any thread.
bool host_clock_is_synchronized();

/// Reads the Unix time of host time 0, nanoseconds.
using EpochReader = std::function<std::int64_t()>;

/// Unix time of host time 0, read again every second, since the system time may be set while a run
/// goes on. Not thread-safe.
class HeldEpoch {
 public:
  explicit HeldEpoch(EpochReader read) : read_(std::move(read)) {}
  /// Returns the Unix time of host time 0, nanoseconds. What differs by less than kLeastStep from
  /// the last one is taken for the error of reading two clocks, and ignored.
  std::int64_t at(HostTime now);

  static constexpr Duration kLeastStep = std::chrono::milliseconds(50);

 private:
  EpochReader read_;
  std::int64_t held_ns_ = 0;
  std::optional<HostTime> read_at_;
};

}  // namespace mixrig
