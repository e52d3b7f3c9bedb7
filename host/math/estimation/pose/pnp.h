// SPDX-License-Identifier: Apache-2.0
// Pose of a camera from known points and the directions in which it sees them.
#pragma once

#include <span>

#include "host/math/estimation/points/bearing.h"
#include "host/math/estimation/verdict.h"
#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

/// Estimates camera_from_world by robust sampling of P3P and least squares of the whitened
/// reprojection error, for pinhole and fisheye lenses. Covariance: see pose_error(), 6x6.
/// Residuals: length of the whitened error per point, in sigmas. Degenerate: fewer than 4 points,
/// collinear points, a second pose that fits as well (the flip of a small or distant plane), points
/// behind the camera, contradicting points, values that are not finite.
Estimate<geometry::Pose> solve_pnp(std::span<const Eigen::Vector3d> points_m,
                                   std::span<const Bearing> bearings);

}  // namespace mixrig::estimation
