// SPDX-License-Identifier: Apache-2.0
// A rig as it was built: the preset with the tolerances of one specimen, and its pan-tilt unit.
#pragma once

#include <vector>

#include "host/studio/rig.h"

namespace mixrig::studio {

/// Angle to the axis -> radius: focal (angle + k1 angle^3 + k2 angle^5), in pixels.
struct FisheyeOptics {
  Size size_px;
  double f_px = 0, cx_px = 0, cy_px = 0, k1 = 0, k2 = 0;
  double field_rad = 0;  ///< full angle of the circle that gets light
};

/// Unit ray of a fisheye pixel by Newton steps; false outside the circle.
bool fisheye_ray(const FisheyeOptics& optics, double u_px, double v_px, Eigen::Vector3d& ray);

/// A turn about a line, in the target camera's axes at pan = tilt = 0.
struct TurnAxis {
  Eigen::Vector3d direction;  ///< unit; the turn is right-handed
  Eigen::Vector3d point_m;    ///< the line's point nearest to the other axis
  double scale = 1;           ///< true angle = scale * reported angle
};

/// rest_from_turned(pan, tilt) = pan turn * tilt turn.
struct PanTiltUnit {
  TurnAxis pan, tilt;
  double step_rad = 0;
  double repeatability_rad = 0;  ///< sigma of what the encoder does not see
};

struct BoardRig {
  Optics target;
  TofSensor tof;
  FisheyeOptics fisheye;
  geometry::Pose target_from_fisheye;
  PanTiltUnit pan_tilt;
};

/// The rig of a seed: focal lengths within 1 %, mounting within 4 mm and 0.6 degrees of the preset.
/// `depth_error_m` is the largest systematic depth error.
BoardRig make_board_rig(RigPreset preset, unsigned seed, Size target_px, double depth_error_m);

/// Pose of the turned target camera in the axes that it has at pan = tilt = 0.
geometry::Pose rest_from_turned(const PanTiltUnit& unit, double pan_rad, double tilt_rad);

/// Systematic error of a measured distance, metres.
double depth_error_m(const TofSensor& sensor, double distance_m);

}  // namespace mixrig::studio
