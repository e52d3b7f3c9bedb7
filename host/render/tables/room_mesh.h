// SPDX-License-Identifier: Apache-2.0
// The real room as far as it was learned, as a coarse mesh: what stands between lamps and objects.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// World axes, metres. Not closed: what no camera saw is missing.
struct RoomMesh {
  std::vector<glm::vec3> positions_m;
  std::vector<std::uint32_t> indices;  ///< three a triangle, turned to any side
};

/// Of the still background as the camera at `world_from_camera` sees it, or of all background
/// models. Some 40000 vertices a picture; cut at depth steps. Empty without a background.
RoomMesh make_room_mesh(const CompositorSetup& setup, const geometry::Pose& world_from_camera);

}  // namespace mixrig::render
