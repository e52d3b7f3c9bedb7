// SPDX-License-Identifier: Apache-2.0
// Light of the lamps that the real room hides near the virtual objects: found once, in a grid that
// both back ends sample. Where a real thing already hides a lamp, a virtual one adds no second
// shadow and is dark itself.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// A grid of points along the world's axes, around the virtual objects and the real surfaces that
/// their shadows can reach.
struct RoomShade {
  glm::dvec3 first_m{0};  ///< cell (0, 0, 0), in world axes
  double cell_m = 0;      ///< distance between neighbours along every axis
  glm::ivec3 cells{0};
  std::vector<int> layer_of;  ///< for each lamp its layer of `share`; -1: nothing real hides it
  int layers = 0;
  std::vector<float> share;  ///< visible share of the lamp at each point, 0..1: [layer][z][y][x]
  bool empty() const { return layers == 0; }
};

/// Builds the grid from the learned room; `world_from_camera` is the pose at which a still
/// background was learned. Things nearer to a point than a cell do not hide lamps from it. Takes up
/// to a second; pure. Precondition: validate(setup) holds.
RoomShade make_room_shade(const CompositorSetup& setup, const geometry::Pose& world_from_camera);

/// Whether the setup needs the grid: it has lamps, objects, and a real room that is shown around
/// them.
bool needs_room_shade(const CompositorSetup& setup);

}  // namespace mixrig::render
