// SPDX-License-Identifier: Apache-2.0
// Finds walls and sides of furniture as flat upright faces.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "extras/people/plan/floor_map.h"

namespace mixrig::touch {

/// An upright rectangle that stands on the floor.
struct RoomSide {
  Eigen::Vector2d from_m, to_m;  ///< on the floor, world
  Eigen::Vector2d normal;        ///< unit, towards the free floor
  double top_m = 0;
};

/// Fits lines to the points of upright surfaces by growing runs of map cells that lie on one line;
/// at least 0.25 m long. Round and small things give none. Pure.
std::vector<RoomSide> find_sides(std::span<const plan::RoomPoint> points,
                                 const plan::FloorMap& map);

}  // namespace mixrig::touch
