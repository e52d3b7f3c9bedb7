// SPDX-License-Identifier: Apache-2.0
// Helpers of the files that bring lamps and objects into camera axes.
#pragma once

#include <span>

#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// World from object axes, with the object's scale.
inline glm::dmat4 world_from(const VirtualObject& object) {
  glm::dmat4 m = to_glm(object.world_from_object.matrix());
  for (int column = 0; column < 3; ++column) m[column] *= object.scale;
  return m;
}

inline glm::dvec3 apply(const glm::dmat4& m, const glm::dvec3& p) {
  return glm::dvec3(m * glm::dvec4(p, 1));
}

/// Tangent of half the largest field of view of a shadow map: 143 degrees in all.
inline constexpr double kLargestTanHalf = 3.0;

/// Parameters of a grid along the world's axes whose first point is `first_m`.
inline RoomShadeParams grid_params(const glm::dvec3& first_m, double cell_m,
                                   const glm::ivec3& cells, const glm::dmat4& world_from_camera) {
  const double scale = 1 / cell_m;
  glm::dmat4 cell_from_world(scale);
  cell_from_world[3] = glm::dvec4(-scale * first_m, 1);
  return {glm::mat4(cell_from_world * world_from_camera), cells};
}

/// Extends `rect` by the view pixels of a box; by the whole view if the box reaches behind the
/// camera.
void include_box(std::span<const glm::dvec3> corners, const glm::dmat4& camera_from_world,
                 const geometry::Pinhole& view, Rect& rect);

/// Each lamp as a single, whole part.
std::vector<LampPart> whole_lamps(const std::vector<geometry::Lamp>& lamps);

}  // namespace mixrig::render
