// SPDX-License-Identifier: Apache-2.0
// Finds where a body stands on the floor, of which only one side was seen.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "extras/people/plan/clusters.h"

namespace mixrig::plan {

/// Widths of a trunk as seen from one direction.
struct BodyWidth {
  /// Half width of the trunk: the width of its middle half. In KnownBody the mean of views.
  double half_m = 0;
  double reach_m = 0;  ///< distance from the middle to the sides, arms included
};

inline constexpr BodyWidth kAverageBody{0.18, 0.2};

/// Measures of a body from earlier frames.
struct KnownBody {
  double height_m = 0;  ///< 0: not known
  std::optional<BodyWidth> width;
};

struct BodyPlace {
  Eigen::Vector2d on_floor_m = Eigen::Vector2d::Zero();  ///< below the trunk's axis, world
  /// Covariance of `on_floor_m` by the body's shape, which changes with each step.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  BodyWidth width;         ///< as seen from here, or as known
  bool is_whole = false;   ///< both sides of the trunk were seen
  bool has_trunk = false;  ///< more than a part of the trunk was seen
};

/// Finds the middle of the seen trunk and moves it from the surface to the axis. The trunk is
/// modelled as an upright elliptic cylinder: seen from any side, its surface lies on average pi/4 a
/// b / h before its axis, where the product of the half axes a and b follows from height and mean
/// width, and h is the half width that is seen. Middle and h are those of the middle half of the
/// surface, which swinging arms hardly move. Where something nearer or the picture's border hides
/// one side, the axis is at `reach_m` (of earlier frames, else of an average body) from the other
/// side. Where both are hidden or no trunk is seen, it is the middle of the seen part, with a
/// larger covariance. `eye_m`: position of the camera. Pure.
BodyPlace place_body(const Cluster& cluster, const Eigen::Vector3d& eye_m, const KnownBody& known);

}  // namespace mixrig::plan
