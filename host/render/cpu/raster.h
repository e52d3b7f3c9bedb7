// SPDX-License-Identifier: Apache-2.0
// Triangles in homogeneous coordinates (Olano and Greer 1997): what crosses the camera plane needs
// no clipping, samples behind the camera have a negative inverse depth.
#pragma once

#include <array>
#include <optional>

#include <glm/glm.hpp>

#include "host/render/prepare.h"

namespace mixrig::render::cpu {

/// A grid of sample points before a pinhole.
struct SampleGrid {
  glm::dvec2 focal{1}, center{0};
  Rect rect;  ///< samples that exist
};

/// a x + b y + c of a sample's column and row, relative to the triangle's first.
struct Affine {
  float a = 0, b = 0, c = 0;
};

/// A triangle ready to be filled: inside where all three shares are positive.
struct Triangle {
  Rect box;                     ///< samples that it may cover
  std::array<Affine, 3> share;  ///< of each vertex in the inverse depth; their sum is w = 1/z
};

enum class Facing { kFront, kBoth };

/// Sets up a triangle of camera-axes vertices, counter-clockwise seen from the front; nullopt where
/// it shows its back, has no area or lies outside the grid.
std::optional<Triangle> set_up(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                               const SampleGrid& grid, Facing facing);

/// Calls fill(x, y, w, shares) for the samples in rows [y0, y1). A border that two triangles share
/// belongs to both, with a small overlap against cracks; the caller keeps the nearest surface.
template <typename Fill>
void for_each_sample(const Triangle& t, int y0, int y1, Fill&& fill) {
  for (int y = std::max(y0, t.box.y0); y < std::min(y1, t.box.y1); ++y) {
    const float dy = static_cast<float>(y - t.box.y0);
    for (int x = t.box.x0; x < t.box.x1; ++x) {
      const float dx = static_cast<float>(x - t.box.x0);
      const auto at = [&](const Affine& s) { return s.a * dx + (s.b * dy + s.c); };
      const glm::vec3 shares(at(t.share[0]), at(t.share[1]), at(t.share[2]));
      const float w = shares.x + shares.y + shares.z;
      const float border = -1e-5F * w;
      if (shares.x >= border && shares.y >= border && shares.z >= border && w > 0 &&
          w < static_cast<float>(1 / kNearestM))
        fill(x, y, w, shares);
    }
  }
}

}  // namespace mixrig::render::cpu
