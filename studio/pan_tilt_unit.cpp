// SPDX-License-Identifier: Apache-2.0
#include "studio/pan_tilt_unit.h"

#include <cmath>

namespace mixrig::studio {
namespace {

geometry::Pose turn_about(const TurnAxis& axis, double reported_rad) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(axis.scale * reported_rad, axis.direction));
  return {turn, axis.point_m - turn * axis.point_m};
}

}  // namespace

geometry::Pose rest_from_turned(const PanTiltUnit& unit, double pan_rad, double tilt_rad) {
  return turn_about(unit.pan, pan_rad) * turn_about(unit.tilt, tilt_rad);
}

double whole_steps(const PanTiltUnit& unit, double angle_rad) {
  return unit.step_rad * std::round(angle_rad / unit.step_rad);
}

}  // namespace mixrig::studio
