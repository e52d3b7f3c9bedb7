// SPDX-License-Identifier: Apache-2.0
// One rectangle as a mesh, and the parameters of a frame that draws it.
#pragma once

#include <array>

#include "host/render/tables/prepare.h"

namespace mixrig::test {

/// Upright rectangle at z, front towards -z (a camera that looks along z), in a camera's own axes:
/// x right, y down.
struct Quad {
  Quad(glm::vec2 low, glm::vec2 high, float z, bool faces_camera = true) {
    positions_m = {glm::vec3(low, z), {low.x, high.y, z}, {high, z}, {high.x, low.y, z}};
    normals.fill(glm::vec3(0, 0, faces_camera ? -1 : 1));
    uv = {glm::vec2(0, 0), {0, 1}, {1, 1}, {1, 0}};
    // Counter-clockwise in the picture: down the left side first.
    indices = faces_camera ? std::array<std::uint32_t, 6>{0, 1, 2, 0, 2, 3}
                           : std::array<std::uint32_t, 6>{0, 2, 1, 0, 3, 2};
    view = {positions_m, normals, uv, indices, glm::vec3(1), {}, false};
  }
  Quad(const Quad&) = delete;
  Quad& operator=(const Quad&) = delete;

  std::array<glm::vec3, 4> positions_m, normals;
  std::array<glm::vec2, 4> uv;
  std::array<std::uint32_t, 6> indices;
  render::MeshView view;
};

inline render::Draw draw_of(const Quad& quad, const render::PinholeParams& view) {
  render::Draw draw;
  draw.mesh = &quad.view;
  draw.params.base_color = quad.view.base_color;
  draw.params.view = view;
  return draw;
}

}  // namespace mixrig::test
