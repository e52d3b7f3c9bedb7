// SPDX-License-Identifier: Apache-2.0
// Estimates a camera's motion between two pictures from rays alone.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/math/estimation/points/bearing.h"
#include "host/math/geometry/pose.h"

namespace mixrig::reconstruction {

/// Rays of one point in two pictures.
struct RayPair {
  estimation::Bearing a, b;
};

struct TwoViews {
  geometry::Pose b_from_a;   ///< translation of length 1
  std::vector<int> inliers;  ///< indices of the pairs that agree, in front of both cameras
  /// Median angle (rad) between the rays of the inliers after the best pure rotation is removed;
  /// about 0 for a camera that only rotates.
  double parallax_rad = 0;
  /// Share of the pairs agreeing with the motion (in front or not) that the best pure rotation also
  /// explains within 3 sigma; nearly 1 where the camera only rotates.
  double turned_share = 0;
};

/// Estimates the motion by the five-point method under random sampling (MSAC, at most `trials`
/// samples). nullopt for fewer than 15 pairs, or where fewer than 15 or less than 40 % of them
/// agree.
std::optional<TwoViews> relate_views(std::span<const RayPair> pairs, int trials = 400);

}  // namespace mixrig::reconstruction
