// SPDX-License-Identifier: Apache-2.0
// Fits a plane and its uncertainty without outliers; uses geometry::fit_plane.
#pragma once

#include <optional>
#include <span>

#include "host/math/estimation/verdict.h"
#include "host/math/geometry/plane.h"

namespace mixrig::estimation {

/// A plane and the frame in which its error is given.
struct PlaneFit {
  geometry::Plane plane;
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();  ///< wide axis first
};

/// Fits a plane by total least squares. `sigma_m`: noise of a point along the normal; if it is
/// given, outliers are searched for too. Covariance 3x3 of (tilt of the normal towards tangent 0,
/// towards tangent 1 in rad, offset at the centroid in m). Residuals: signed distances, m.
/// Degenerate: fewer than 3 points (4 without sigma), coinciding or collinear points to within
/// their noise, contradicting points, values that are not finite.
Estimate<PlaneFit> fit_plane_robust(std::span<const Eigen::Vector3d> points_m,
                                    std::optional<double> sigma_m = {});

}  // namespace mixrig::estimation
