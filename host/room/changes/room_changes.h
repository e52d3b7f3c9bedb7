// SPDX-License-Identifier: Apache-2.0
// What of a room is no longer as its model says.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

namespace mixrig::model {

enum class ChangeKind {
  kAppeared,  ///< a thing stands where the model has free space
  kGone,      ///< the model has a surface where the camera sees through
  kMoved,     ///< both, of the same size
  kColor,     ///< a surface in its place has another colour
  kLights,    ///< the light of most of the room has another strength
};
std::string_view name(ChangeKind kind);

/// One of them. World axes, metres; seconds of the frames that were added.
struct RoomChange {
  ChangeKind kind = ChangeKind::kAppeared;
  Eigen::Vector3d center_m{0, 0, 0};      ///< of the box around it; of what moved where it is now
  Eigen::Vector3d size_m{0, 0, 0};        ///< of that box, along the axes of the world
  std::optional<Eigen::Vector3d> from_m;  ///< where it was, of what moved
  double since_s = 0;                     ///< first seen
  double found_s = 0;                     ///< when it was certain
  double seen_s = 0;                      ///< last seen
  /// Share of the observations of its place, those in which something hid it left out, that agree;
  /// of lights the share of the room that agrees with the factor.
  double certainty = 0;
  /// Root mean square of how its depth moves about its mean, in the median over it; of what
  /// appeared.
  double unrest_m = 0;
  Eigen::Array3d factor{1, 1, 1};  ///< of lights, and of a colour: linear red, green, blue
  bool common = true;              ///< of lights: one factor for the room; else it varies by place
  bool over = false;               ///< it is as the model says again
  bool accepted = false;           ///< into the model
};

/// "a thing of 0.5 x 0.5 x 0.9 m moved from (4.2, 3.5, 0.5) to (3.5, 3.0, 0.5) m".
std::string text(const RoomChange& change);

}  // namespace mixrig::model
