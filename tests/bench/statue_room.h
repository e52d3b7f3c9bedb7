// SPDX-License-Identifier: Apache-2.0
// The analytic room with what a studio scene has: four ceiling panels and a textured figure of
// some 5000 triangles.
#pragma once

#include <vector>

#include "tests/gl/room_setup.h"

namespace mixrig::test {

struct StatueRoom : RoomSetup {
  explicit StatueRoom(const Options& options);

 private:
  Image<Rgb8> skin_;
  std::vector<glm::vec3> positions_m_, normals_;
  std::vector<glm::vec2> uv_;
  std::vector<std::uint32_t> indices_;
};

}  // namespace mixrig::test
