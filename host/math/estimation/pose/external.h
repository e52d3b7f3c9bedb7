// SPDX-License-Identifier: Apache-2.0
// The pose of a camera on a tracked body (external calibration: Cortes Reina 2015, section 3.1).
#pragma once

#include <span>

#include "host/math/estimation/points/bearing.h"
#include "host/math/estimation/verdict.h"
#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

/// A marker at a known position, with the depth camera's measurement of it.
struct RangedSight {
  Eigen::Vector3d world_m = Eigen::Vector3d::Zero();
  Bearing bearing;
  double range_m = 0;  ///< distance to the optical centre, not z
};

/// Estimates world_from_camera by least squares of directions and distances together. Cortes Reina
/// 2015 uses the distances alone, which do not determine the orientation and, for markers near one
/// plane, determine the height only weakly. `sigma_range_m`: noise of a distance. Covariance:
/// pose_error(), 6x6. Residuals: length of the whitened error per marker, in sigmas. Degenerate:
/// fewer than 3 markers, collinear ones, contradicting ones, values that are not finite.
Estimate<geometry::Pose> locate_camera(std::span<const RangedSight> sights, double sigma_range_m);

/// Returns body_from_camera, with the covariance of both poses; degenerate if one of them is.
Estimate<geometry::Pose> body_from_camera(const Estimate<geometry::Pose>& world_from_body,
                                          const Estimate<geometry::Pose>& world_from_camera);

}  // namespace mixrig::estimation
