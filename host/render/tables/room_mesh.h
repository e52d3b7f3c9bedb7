// SPDX-License-Identifier: Apache-2.0
// The learned real room as a coarse mesh, which can stand between lamps and objects.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// Triangles in world axes, metres. Not closed: surfaces that no camera saw are missing.
struct RoomMesh {
  std::vector<glm::vec3> positions_m;
  std::vector<std::uint32_t> indices;  ///< three a triangle, of either orientation
};

/// Builds the mesh of the still background as the camera at `world_from_camera` sees it, or of all
/// background models: some 40000 vertices a picture, cut at depth steps. Empty without a
/// background.
RoomMesh make_room_mesh(const CompositorSetup& setup, const geometry::Pose& world_from_camera);

}  // namespace mixrig::render
