// SPDX-License-Identifier: Apache-2.0
// The machine's system clock: its state, and its two time scales.
#pragma once

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

}  // namespace mixrig
