// SPDX-License-Identifier: Apache-2.0
// Where a virtual object can stand so that nobody walks through it.
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

/// How the camera sees the empty room.
struct RoomView {
  ImageView<const float> depth_m;  ///< z, 0 unknown: it hides nothing
  geometry::Pinhole view;
  geometry::Pose world_from_view;
};

struct PlacingOptions {
  double margin_m = 0.1;                  ///< between the box and what stands in the room
  double path_margin_m = 0.35;            ///< between the box and the axis of who walks
  double step_m = 0.1;                    ///< of the places that are tried
  int turns = 8;                          ///< in half a turn
  double apart_m = 0.5;                   ///< of the places that are suggested
  std::optional<Eigen::Vector3d> lamp_m;  ///< the brightest
};

struct FreePlace {
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();  ///< middle of the box, world
  double yaw_rad = 0;                              ///< of its width, from the world's x
  double visible_share = 0;                        ///< of its sides that face the camera
  double shadow_share = 0;  ///< of its shadow by the lamp, that falls on free floor; 1 without
  double path_m = 0;        ///< from its middle to the nearest path; 100: there is none
  double room_m = 0;        ///< from its middle to the nearest thing, as far as is looked: 1 m
  double score = 0;
};

/// The best `count` places, best first: the visible share counts, what is equal in it is ordered by
/// shadow and distance to the paths. None where nothing is free. Pure.
std::vector<FreePlace> suggest_places(const FloorMap& map, std::span<const Eigen::Vector2d> paths_m,
                                      const Footprint& box, const RoomView& view, int count,
                                      const PlacingOptions& options = {});

/// Share of points on the sides of a box that face the camera which it sees. Pure.
double visible_share(const Footprint& box, const Eigen::Vector2d& at_m, double yaw_rad,
                     const RoomView& view);

}  // namespace mixrig::plan
