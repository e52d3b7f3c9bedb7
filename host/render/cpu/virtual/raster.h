// SPDX-License-Identifier: Apache-2.0
// Rasterises triangles in homogeneous coordinates (Olano and Greer 1997): triangles that cross the
// camera plane need no clipping; samples behind the camera have negative inverse depth.
#pragma once

#include <array>
#include <optional>
#include <utility>

#include <glm/glm.hpp>

#include "host/render/cpu/simd.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// A grid of sample points of a pinhole.
struct SampleGrid {
  glm::dvec2 focal{1}, center{0};
  Rect rect;         ///< the samples that exist
  double shift = 0;  ///< largest offset by which for_each_run() moves samples along each axis
};

/// Function a x + b y + c of a sample's column and row, relative to the triangle's first.
struct Affine {
  float a = 0, b = 0, c = 0;
};

/// A triangle ready to be filled: a sample is inside where all three shares are positive.
struct Triangle {
  Rect box;                     ///< samples that it may cover
  std::array<Affine, 3> share;  ///< of each vertex in the inverse depth; their sum is w = 1/z
};

enum class Facing { kFront, kBoth };

/// Sets up a triangle of camera-axes vertices, counter-clockwise seen from the front; nullopt if it
/// shows its back, has no area or lies outside the grid.
std::optional<Triangle> set_up(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                               const SampleGrid& grid, Facing facing);

/// Vector 0, 1, 2, ...
template <int... kLane>
constexpr FloatLanes count_up(std::integer_sequence<int, kLane...>) {
  return FloatLanes{static_cast<float>(kLane)...};
}
inline constexpr FloatLanes kLaneNumber = count_up(std::make_integer_sequence<int, kLanes>());

/// Vector -1, 1, -1, 1, ...
template <int... kLane>
constexpr FloatLanes alternate(std::integer_sequence<int, kLane...>) {
  return FloatLanes{(kLane % 2 == 0 ? -1.0F : 1.0F)...};
}
inline constexpr FloatLanes kAlternate = alternate(std::make_integer_sequence<int, kLanes>());

/// Calls fill(x, y, w, inside) for runs of kLanes samples from (x, y) on, in rows [y0, y1), which
/// cover all samples of the triangle; `inside` marks those in it. Runs start at `last_x` at most,
/// so a sample can come twice. `shift` (in samples) rotates each 2x2 samples about their centre:
/// even rows move right and odd ones left, even columns up and odd ones down. A border that two
/// triangles share belongs to both, with a small overlap against cracks; the caller keeps the
/// nearest surface.
template <typename Fill>
void for_each_run(const Triangle& t, int y0, int y1, int last_x, float shift, Fill&& fill) {
  const float width = static_cast<float>(t.box.x1 - t.box.x0);
  for (int y = std::max(y0, t.box.y0); y < std::min(y1, t.box.y1); ++y) {
    const float dy = static_cast<float>(y - t.box.y0);
    const float right = y % 2 == 0 ? shift : -shift;
    const float first0 = t.share[0].a * right + (t.share[0].b * dy + t.share[0].c);
    const float first1 = t.share[1].a * right + (t.share[1].b * dy + t.share[1].c);
    const float first2 = t.share[2].a * right + (t.share[2].b * dy + t.share[2].c);
    for (int x = t.box.x0; x < t.box.x1; x += kLanes) {
      const int at = std::min(x, last_x);
      const FloatLanes dx = kLaneNumber + static_cast<float>(at - t.box.x0);
      const FloatLanes down = kAlternate * (at % 2 == 0 ? shift : -shift);
      const FloatLanes share0 = dx * t.share[0].a + (down * t.share[0].b + first0);
      const FloatLanes share1 = dx * t.share[1].a + (down * t.share[1].b + first1);
      const FloatLanes share2 = dx * t.share[2].a + (down * t.share[2].b + first2);
      const FloatLanes w = share0 + share1 + share2;
      const FloatLanes border = w * -1e-5F;
      const IntLanes inside = (share0 >= border) & (share1 >= border) & (share2 >= border) &
                              (w > 0) & (w < static_cast<float>(1 / kNearestM)) & (dx >= 0) &
                              (dx < width);
      fill(at, y, w, inside);
    }
  }
}

}  // namespace mixrig::render::cpu
