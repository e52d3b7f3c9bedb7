// SPDX-License-Identifier: Apache-2.0
// Finds places for a virtual object where nobody walks through it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "extras/people/plan/floor_map.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"

namespace mixrig::plan {

/// A box on the floor.
struct Footprint {
  Eigen::Vector2d size_m{0.5, 0.5};  ///< width, depth
  double height_m = 1;
};

/// Depth of the empty room as the camera sees it.
struct RoomView {
  ImageView<const float> depth_m;  ///< z, 0 unknown: it hides nothing
  geometry::Pinhole view;
  geometry::Pose world_from_view;
};

struct PlacingOptions {
  double margin_m = 0.1;                  ///< between the box and what stands in the room
  double path_margin_m = 0.35;            ///< between the box and the axis of a walking person
  double step_m = 0.1;                    ///< distance of the tried places
  int turns = 8;                          ///< orientations tried in half a turn
  double apart_m = 0.5;                   ///< least distance of suggested places
  std::optional<Eigen::Vector3d> lamp_m;  ///< position of the brightest lamp
};

struct FreePlace {
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();  ///< middle of the box, world
  double yaw_rad = 0;        ///< direction of the box's width, from the world's x
  double visible_share = 0;  ///< share of the sides facing the camera that is visible
  double shadow_share = 0;   ///< of the lamp's shadow that falls on free floor; 1 without a lamp
  double path_m = 0;         ///< from the box's middle to the nearest path; 100: no path
  double room_m = 0;         ///< from the box's middle to the nearest thing, at most 1 m
  double score = 0;
};

/// The `count` places of the highest score, best first: the visible share counts, and a little the
/// shadow and the distance to the paths. Empty where nothing is free. Pure.
std::vector<FreePlace> suggest_places(const FloorMap& map, std::span<const Eigen::Vector2d> paths_m,
                                      const Footprint& box, const RoomView& view, int count,
                                      const PlacingOptions& options = {});

/// Share of the points on those sides of a box that face the camera which the camera sees. Pure.
double visible_share(const Footprint& box, const Eigen::Vector2d& at_m, double yaw_rad,
                     const RoomView& view);

}  // namespace mixrig::plan
