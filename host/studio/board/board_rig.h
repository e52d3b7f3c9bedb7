// SPDX-License-Identifier: Apache-2.0
// A rig with manufacturing tolerances: a preset varied by seed, and its pan-tilt unit.
#pragma once

#include <vector>

#include "host/studio/rig.h"

namespace mixrig::studio {

/// radius_px = f_px (angle + k1 angle^3 + k2 angle^5), where angle is that to the optical axis.
struct FisheyeOptics {
  Size size_px;
  double f_px = 0, cx_px = 0, cy_px = 0, k1 = 0, k2 = 0;
  double field_rad = 0;  ///< full field of view of the image circle
};

/// Unit ray of a fisheye pixel, by Newton's method; false outside the image circle.
bool fisheye_ray(const FisheyeOptics& optics, double u_px, double v_px, Eigen::Vector3d& ray);

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

struct BoardRig {
  Optics target;
  TofSensor tof;
  FisheyeOptics fisheye;
  geometry::Pose target_from_fisheye;
  PanTiltUnit pan_tilt;
};

/// The rig of a seed: focal lengths within 1 %, mounting within 4 mm and 0.6 degrees (each axis) of
/// the preset. `depth_error_m` is the largest systematic depth error.
BoardRig make_board_rig(RigPreset preset, unsigned seed, Size target_px, double depth_error_m);

/// Pose of the turned target camera in the axes that it has at pan = tilt = 0.
geometry::Pose rest_from_turned(const PanTiltUnit& unit, double pan_rad, double tilt_rad);

/// Systematic error of a measured distance, metres.
double depth_error_m(const TofSensor& sensor, double distance_m);

}  // namespace mixrig::studio
