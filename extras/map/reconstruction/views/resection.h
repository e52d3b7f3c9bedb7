// SPDX-License-Identifier: Apache-2.0
// Estimates a camera's pose from places and the rays that see them, many of which may be wrong.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/math/estimation/points/bearing.h"
#include "host/math/geometry/pose.h"

namespace mixrig::reconstruction {

struct Resection {
  geometry::Pose camera_from_map;
  /// Covariance of (rotation vector rad, translation), R = exp(w) * R_estimate, with the places
  /// taken as exact.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<int> inliers;  ///< within 3 sigma
  double rms = 0;            ///< of the inliers' errors, in sigmas of one coordinate
};

/// Refines a start that is nearly right: Gauss-Newton on ray_error() with Tukey's weights. nullopt
/// where fewer than 6 places agree or they do not determine the pose.
std::optional<Resection> refine_pose(std::span<const Eigen::Vector3d> places,
                                     std::span<const estimation::Bearing> rays,
                                     const geometry::Pose& start);

/// Finds the pose without a start: the best of `trials` samples of three (estimation::solve_p3p,
/// MSAC with `limit` sigmas), refined.
std::optional<Resection> find_pose(std::span<const Eigen::Vector3d> places,
                                   std::span<const estimation::Bearing> rays, double limit = 4,
                                   int trials = 500);

}  // namespace mixrig::reconstruction
