// SPDX-License-Identifier: Apache-2.0
// Changes of a room relative to its model.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

namespace mixrig::model {

enum class ChangeKind {
  kAppeared,  ///< a thing stands where the model has free space
  kGone,      ///< the camera sees through a surface of the model
  kMoved,     ///< both of these, of the same size
  kColor,     ///< a surface has another colour at its place
  kLights,    ///< the light of most of the room has another strength
};
std::string_view name(ChangeKind kind);

/// One change. World axes, metres; times in seconds of the frames that were added.
struct RoomChange {
  ChangeKind kind = ChangeKind::kAppeared;
  Eigen::Vector3d center_m{0, 0, 0};      ///< centre of its box; of a moved thing, where it is now
  Eigen::Vector3d size_m{0, 0, 0};        ///< size of that box along the world's axes
  std::optional<Eigen::Vector3d> from_m;  ///< kMoved only: where it was
  double since_s = 0;                     ///< first seen
  double found_s = 0;                     ///< time at which it became certain
  double seen_s = 0;                      ///< last seen
  /// Share of observations of its place that confirm it, except those in which something hid the
  /// place. For lights: share of the room that agrees with the factor.
  double certainty = 0;
  /// Movement of a thing that appeared: root mean square of its depth about its mean, median over
  /// its cells, metres.
  double unrest_m = 0;
  Eigen::Array3d factor{1, 1, 1};  ///< of lights or of a colour: linear red, green, blue
  bool common = true;     ///< of lights: one factor for the whole room; else it varies by place
  bool over = false;      ///< the room is as the model says again
  bool accepted = false;  ///< taken over into the model
};

/// One line, such as "a thing of 0.5 x 0.5 x 0.9 m moved from (4.2, 3.5, 0.5) to (3.5, 3.0, 0.5)
/// m".
std::string text(const RoomChange& change);

}  // namespace mixrig::model
