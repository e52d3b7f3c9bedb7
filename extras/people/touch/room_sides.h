// SPDX-License-Identifier: Apache-2.0
// Walls and sides of furniture as flat upright faces.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "extras/people/plan/floor_map.h"

namespace mixrig::touch {

/// An upright rectangle from the floor on.
struct RoomSide {
  Eigen::Vector2d from_m, to_m;  ///< on the floor, world
  Eigen::Vector2d normal;        ///< unit, towards the free floor
  double top_m = 0;
};

/// Lines through the points of upright surfaces, by growing runs of map cells that lie on one; at
/// least 0.25 m long. What is round or small has none. Pure.
std::vector<RoomSide> find_sides(std::span<const plan::RoomPoint> points,
                                 const plan::FloorMap& map);

}  // namespace mixrig::touch
