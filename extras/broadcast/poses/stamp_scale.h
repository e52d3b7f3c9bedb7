// SPDX-License-Identifier: Apache-2.0
// Time scale of a sender's stamps: UTC, or PTP's TAI, which is ahead of it by whole seconds.
#pragma once

#include <cstdint>

#include "hal/base/clock_sync.h"

namespace mixrig::pose {

/// Reads stamps of a sender whose clock is set by the same source as this machine's. Unless PTP is
/// stated, the scale is the one that brings a stamp within kNear of the system clock. Warns once of
/// PTP that was not stated, and once of stamps that are near on neither scale. One thread.
class StampScale {
 public:
  static constexpr Duration kNear = std::chrono::seconds(2);
  StampScale(bool is_ptp, Duration tai_minus_utc)
      : stated_(is_ptp), is_tai_(is_ptp), tai_minus_utc_(tai_minus_utc) {}

  /// Time of a stamp in nanoseconds since 1970, which was received at `now`.
  UtcTime utc_of(std::int64_t stamp_ns, UtcTime now);

 private:
  void choose(Duration ahead);

  const bool stated_;
  bool is_tai_;
  const Duration tai_minus_utc_;
  bool ptp_warned_ = false, far_warned_ = false;
};

}  // namespace mixrig::pose
