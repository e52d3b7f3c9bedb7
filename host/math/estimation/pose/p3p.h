// SPDX-License-Identifier: Apache-2.0
// The minimal pose problem: three points, three directions, up to four poses.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

/// Poses camera_from_world that put three points on three unit directions in front of the camera:
/// Grunert's quartic (as in Haralick et al. 1994, eq. 9), refined by Newton's method.
/// Empty for coinciding or collinear points.
std::vector<geometry::Pose> solve_p3p(const std::array<Eigen::Vector3d, 3>& points_m,
                                      const std::array<Eigen::Vector3d, 3>& directions);

}  // namespace mixrig::estimation
