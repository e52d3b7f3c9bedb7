// SPDX-License-Identifier: Apache-2.0
// A point from the directions in which two or more views see it (Cortes Reina 2015, section
// 2.4.2).
#pragma once

#include <span>

#include "host/math/estimation/points/bearing.h"
#include "host/math/estimation/verdict.h"
#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

/// One view of the point.
struct PointView {
  geometry::Pose world_from_camera;
  Bearing bearing;
};

/// Minimises the whitened reprojection error, starting from the iteratively weighted linear
/// solution of Cortes Reina 2015, eq. 53 to 57. Covariance 3x3 in m^2; residuals: length of the
/// whitened error per view, in sigmas. Outlying views are left out from 4 views on. Weak along the
/// rays where they are nearly parallel; degenerate: fewer than 2 views, no baseline, parallel rays,
/// a point behind a camera or on the baseline, contradicting views, values that are not finite.
Estimate<Eigen::Vector3d> triangulate(std::span<const PointView> views);

}  // namespace mixrig::estimation
