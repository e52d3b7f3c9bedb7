// SPDX-License-Identifier: Apache-2.0
// Estimates when packets without time stamps were due, from their arrival times.
#pragma once

#include <array>
#include <cstddef>

#include "hal/base/clock.h"

namespace mixrig::pose {

/// Models a sender of constant rate whose packets come late by jitter, some not at all. The phase
/// of its ticks is the phase of the earliest packet of the last kKept; each packet belongs to the
/// tick before its arrival. Correct while the jitter stays below half a period; a clock whose rate
/// is off by 200 ppm moves the result by 0.3 ms at 50 Hz. Nothing allocates. One thread.
class ArrivalComb {
 public:
  /// Precondition: rate_hz > 0.
  explicit ArrivalComb(double rate_hz) : period_s_(1 / rate_hz) {}

  /// Time at which the packet received at `received` would have come without jitter: never after
  /// `received`, and never before an earlier result.
  HostTime due(HostTime received);
  /// Root mean square lateness of the packets kept.
  Duration jitter() const;
  /// False where kLeast or more packets have no common phase, because the sender has another rate.
  /// due() then returns the time of arrival.
  bool fits() const;

  static constexpr std::size_t kKept = 64, kLeast = 32;

 private:
  double phase_of(HostTime received) const;

  const double period_s_;
  HostTime first_{}, last_due_{};
  std::array<double, kKept> phases_{};  ///< 0..1, of a period
  std::size_t count_ = 0;               ///< of all packets
  double center_ = 0, earliest_ = 0;    ///< mean phase; least phase about it, -0.5..0
  double agreement_ = 1;                ///< length of the mean of unit vectors
};

}  // namespace mixrig::pose
