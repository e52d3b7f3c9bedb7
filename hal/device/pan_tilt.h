// SPDX-License-Identifier: Apache-2.0
// A motorised pan-tilt head.
#pragma once

#include <cstdint>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::device {

/// Angles of the two axes with the device's signs; calibration determines their directions.
struct PanTiltAngles {
  double pan_rad = 0, tilt_rad = 0;
};

struct PanTiltInfo {
  std::string uri, version;
  PanTiltAngles resolution, minimum, maximum;  ///< one step; reachable range
};

struct PanTiltMotion {
  double speed_rad_s = 0, acceleration_rad_s2 = 0;  ///< 0: unchanged
};

/// Measured positions; each axis is stamped with the time at which the unit read it.
struct PanTiltSample {
  PanTiltAngles angles;
  HostTime pan_at{}, tilt_at{};
};

/// Counts since construction.
struct PanTiltHealth {
  std::uint64_t commands = 0;
  std::uint64_t timeouts = 0;     ///< commands without an answer
  std::uint64_t refused = 0;      ///< commands answered by an error
  std::uint64_t limit_hits = 0;   ///< axis limits hit, as the device reported them
  std::uint64_t returns = 0;      ///< times the line was lost and reopened
  std::uint64_t noise_bytes = 0;  ///< bytes that belonged to no reply
  bool limit_hit = false;         ///< a limit was hit since the last move_to
};

/// A pan-tilt head. For one thread. Errors of every method: kTimeout when the device does not
/// answer, kDevice when it refuses or its answer is invalid.
class PanTilt {
 public:
  virtual ~PanTilt() = default;
  virtual const PanTiltInfo& info() const = 0;
  /// Starts moving and returns at once. Errors: kUsage beyond the limits; then nothing moves.
  virtual Result<void> move_to(PanTiltAngles target) = 0;
  virtual Result<void> set_motion(PanTiltMotion motion) = 0;
  virtual Result<PanTiltSample> sample() = 0;
  /// Stops both axes.
  virtual Result<void> halt() = 0;
  virtual PanTiltHealth health() const = 0;
};

/// Polls until the head is within half a step of `target`. Errors: kTimeout when it does not arrive
/// in time (the line gives the remaining angles), and those of sample().
Result<void> await_position(PanTilt& head, PanTiltAngles target, Clock& clock, Duration timeout);

}  // namespace mixrig::device
