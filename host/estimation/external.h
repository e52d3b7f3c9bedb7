// SPDX-License-Identifier: Apache-2.0
// Where a camera sits on a tracked body (paper C, section 3.1: external calibration).
#pragma once

#include <span>

#include "host/estimation/bearing.h"
#include "host/estimation/verdict.h"
#include "host/geometry/pose.h"

namespace mixrig::estimation {

/// A marker of known place as the depth camera sees it.
struct RangedSight {
  Eigen::Vector3d world_m = Eigen::Vector3d::Zero();
  Bearing bearing;
  double range_m = 0;  ///< distance to the optical centre, not z
};

/// world_from_camera by least squares of directions and distances together: the paper uses the
/// distances alone, which leave the orientation open and, for markers near one plane, a weak
/// height. `sigma_range_m`: noise of a distance. Covariance: pose_error(), 6x6. Residuals: length
/// of the whitened error per marker, in sigmas. Degenerate: fewer than 3 markers, collinear ones,
/// contradicting ones, values that are not finite.
Estimate<geometry::Pose> locate_camera(std::span<const RangedSight> sights, double sigma_range_m);

/// body_from_camera with the covariance of both; degenerate where one of them is.
Estimate<geometry::Pose> body_from_camera(const Estimate<geometry::Pose>& world_from_body,
                                          const Estimate<geometry::Pose>& world_from_camera);

}  // namespace mixrig::estimation
