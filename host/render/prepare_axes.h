// SPDX-License-Identifier: Apache-2.0
// What the files that bring lamps and objects into camera axes share.
#pragma once

#include <span>

#include "host/render/prepare.h"

namespace mixrig::render {

/// Object to world, scaled.
inline glm::dmat4 world_from(const VirtualObject& object) {
  glm::dmat4 m = to_glm(object.world_from_object.matrix());
  for (int column = 0; column < 3; ++column) m[column] *= object.scale;
  return m;
}

inline glm::dvec3 apply(const glm::dmat4& m, const glm::dvec3& p) {
  return glm::dvec3(m * glm::dvec4(p, 1));
}

/// View pixels of a box; the whole view where it reaches behind the camera.
void include_box(std::span<const glm::dvec3> corners, const glm::dmat4& camera_from_world,
                 const geometry::Pinhole& view, Rect& rect);

/// Each lamp as its only part.
std::vector<LampPart> whole_lamps(const std::vector<Lamp>& lamps);

}  // namespace mixrig::render
