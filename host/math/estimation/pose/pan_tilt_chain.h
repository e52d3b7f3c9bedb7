// SPDX-License-Identifier: Apache-2.0
// The axes of a pan-tilt unit and the camera on it, from poses of a target at known angles.
#pragma once

#include <span>

#include "host/math/estimation/verdict.h"
#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

/// Two axes that need not intersect and need not be perpendicular. Frame base: z is the pan axis
/// (right-handed for increasing angles), x the component of the tilt axis at pan 0 perpendicular to
/// z, the origin where the pan axis is closest to the tilt axis. Frame head turns with both axes;
/// at angles 0 it is parallel to base (except for the skew), its origin on the tilt axis.
struct PanTiltChain {
  double skew_rad = 0;  ///< tilt axis towards z; 0 for perpendicular axes
  /// Offset of the tilt axis along y at pan 0; 0 if the axes intersect.
  double offset_m = 0;
  double pan_scale = 1;             ///< true angle over the encoder's angle
  double tilt_scale = 1;            ///< true angle over the encoder's angle
  geometry::Pose head_from_camera;  ///< its translation is the tool centre point
};

/// Poses of head and camera at angles of the encoders.
geometry::Pose base_from_head(const PanTiltChain& chain, double pan_rad, double tilt_rad);
geometry::Pose base_from_camera(const PanTiltChain& chain, double pan_rad, double tilt_rad);

/// The target seen at one position of the unit. `covariance` is that of
/// pose_error(camera_from_target), 6x6, positive definite, as solve_pnp() returns it.
struct PanTiltView {
  double pan_rad = 0, tilt_rad = 0;  ///< angles of the encoders
  geometry::Pose camera_from_target;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

struct PanTiltCalibration {
  PanTiltChain chain;
  geometry::Pose base_from_target;
};

/// Minimises the whitened pose errors, starting from a hand-eye solution with ideal axes.
/// `angle_sigma_rad`: repeatability of each axis, added to the noise of the views, >= 0.
/// Covariance 16x16: skew, offset, pan scale, tilt scale, pose_error() of head_from_camera, then of
/// base_from_target. Residuals: length of the whitened error per view, in sigmas. Degenerate: fewer
/// than 4 views, an axis that did not turn, contradicting views, broken input.
Estimate<PanTiltCalibration> calibrate_pan_tilt(std::span<const PanTiltView> views,
                                                double angle_sigma_rad = 0);

}  // namespace mixrig::estimation
