// SPDX-License-Identifier: Apache-2.0
// What the real room hides of the lamps near the virtual objects: found once, in a grid that both
// back ends look up. Where a real thing already hides a lamp, a virtual one adds no second shadow,
// and is dark itself.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// A grid of points along the world's axes, around the virtual objects and the real surfaces that
/// their shadows can reach.
struct RoomShade {
  glm::dvec3 first_m{0};  ///< of cell (0, 0, 0), world
  double cell_m = 0;      ///< between neighbours along every axis
  glm::ivec3 cells{0};
  std::vector<int> layer_of;  ///< of each lamp: its grid in `share`; -1: nothing real hides it
  int layers = 0;
  std::vector<float> share;  ///< of the lamp that a point sees, 0..1: [layer][z][y][x]
  bool empty() const { return layers == 0; }
};

/// Of the learned room: `world_from_camera` is the pose at which a still background was learned.
/// A thing nearer to a point than a cell hides nothing from it. Takes up to a second; pure.
/// Precondition: validate(setup) holds.
RoomShade make_room_shade(const CompositorSetup& setup, const geometry::Pose& world_from_camera);

/// Whether a scene asks for it: lamps, objects, and a real room that is shown around them.
bool needs_room_shade(const CompositorSetup& setup);

}  // namespace mixrig::render
