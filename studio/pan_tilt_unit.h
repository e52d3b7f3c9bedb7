// SPDX-License-Identifier: Apache-2.0
// The pan-tilt unit: two axes that need not intersect, and the target camera on them.
#pragma once

#include <Eigen/Core>

#include "host/math/geometry/pose.h"

namespace mixrig::studio {

/// One step of the pan-tilt unit, 0.0514 degrees (a PTU-D46's).
inline constexpr double kPanStep_rad = 0.0514 * 3.14159265358979323846 / 180;

/// An axis of rotation, in the target camera's axes at pan = tilt = 0.
struct TurnAxis {
  Eigen::Vector3d direction;  ///< unit; rotation is right-handed
  Eigen::Vector3d point_m;    ///< point of this axis that is nearest to the other axis
  double scale = 1;           ///< true angle = scale * reported angle
};

/// rest_from_turned(pan, tilt) = rotation about pan * rotation about tilt.
struct PanTiltUnit {
  TurnAxis pan, tilt;
  double step_rad = 0;
  double repeatability_rad = 0;  ///< sigma of the angle error that the encoder does not measure
};

struct HeadAngles {
  double pan_rad = 0, tilt_rad = 0;
};

/// Angles of the head and their rates at one time.
struct HeadMotion {
  HeadAngles angles, rate_rad_s;
  double swing_rad = 0;  ///< about the pan axis, not seen by its encoder
};

/// Pose of the turned target camera in the axes that it has at pan = tilt = 0. Angles as the
/// encoders report them, but not quantised.
geometry::Pose rest_from_turned(const PanTiltUnit& unit, double pan_rad, double tilt_rad);

/// The encoder's reading of an angle: the nearest multiple of the step.
double whole_steps(const PanTiltUnit& unit, double angle_rad);

}  // namespace mixrig::studio
