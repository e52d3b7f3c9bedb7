// SPDX-License-Identifier: Apache-2.0
// Finds a known constellation of markers among unlabelled points (Cortes Reina 2015, section
// 2.4.3).
#pragma once

#include <span>
#include <vector>

#include "host/math/estimation/verdict.h"
#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

struct ConstellationOptions {
  double sigma_m = 1e-3;  ///< noise of a coordinate of an observed point, > 0
  /// Fewest markers that make a match; 0: four, or all of a constellation of three.
  int min_markers = 0;
};

struct ConstellationMatch {
  geometry::Pose world_from_body;
  std::vector<int> marker_of_point;  ///< per observed point; -1: not of this body
};

/// Finds the labelling that explains most observed points as markers; markers may be missing, and
/// points may be foreign.
/// Covariance: pose_error() of world_from_body; residuals: distance of each observed point to its
/// marker in m, infinity for foreign points; inliers: indices of observed points.
/// Degenerate: too few markers seen, or a second labelling fits as well (symmetry).
Estimate<ConstellationMatch> match_constellation(std::span<const Eigen::Vector3d> markers_m,
                                                 std::span<const Eigen::Vector3d> observed_m,
                                                 const ConstellationOptions& options = {});

/// Checks that a constellation has no rotational symmetry within noise `sigma_m`: ok, or degenerate
/// naming the markers that can be confused. Call it when a constellation is defined.
Verdict check_constellation(std::span<const Eigen::Vector3d> markers_m, double sigma_m);

}  // namespace mixrig::estimation
