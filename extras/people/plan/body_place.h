// SPDX-License-Identifier: Apache-2.0
// Where on the floor a body stands of which one side was seen.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "extras/people/plan/clusters.h"

namespace mixrig::plan {

/// Of a trunk as it was seen from somewhere.
struct BodyWidth {
  double half_m = 0;   ///< of the trunk: the width of its middle half; known: the mean of views
  double reach_m = 0;  ///< from its middle to its sides, with arms
};

inline constexpr BodyWidth kAverageBody{0.18, 0.2};

/// What earlier frames told of a body.
struct KnownBody {
  double height_m = 0;  ///< 0: not known
  std::optional<BodyWidth> width;
};

struct BodyPlace {
  Eigen::Vector2d on_floor_m = Eigen::Vector2d::Zero();  ///< below the trunk's axis, world
  /// Of the shape of the body, which differs from frame to frame with the steps.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  BodyWidth width;         ///< as seen from here, or as known
  bool is_whole = false;   ///< both sides of the trunk were seen
  bool has_trunk = false;  ///< more than a part of it
};

/// The middle of the seen trunk, moved from the surface to the axis. The trunk is an upright
/// elliptic cylinder: seen from any side, its surface is in the mean pi/4 a b / h before its axis,
/// with the half axes a and b, whose product goes with height and mean width, and the half width h
/// that is seen. Middle and h are those of the
/// middle half of the surface, which swinging arms at its sides hardly move. Where something nearer
/// or the picture's border hides one side, the axis is the reach (that of earlier frames, else of
/// an average body) from the other side; where both are hidden or no trunk is seen, it is the
/// middle of what is, and the covariance says so. `eye_m`: of the camera. Pure.
BodyPlace place_body(const Cluster& cluster, const Eigen::Vector3d& eye_m, const KnownBody& known);

}  // namespace mixrig::plan
