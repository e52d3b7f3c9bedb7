// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual/raster.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

/// Samples that three points may cover; the whole grid if one lies before the near plane.
Rect box_of(const std::array<glm::dvec3, 3>& points, const SampleGrid& grid) {
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  int behind = 0;
  for (const glm::dvec3& p : points) {
    if (p.z < kNearestM) {
      ++behind;
      continue;
    }
    const double x = grid.focal.x * p.x / p.z + grid.center.x;
    const double y = grid.focal.y * p.y / p.z + grid.center.y;
    x0 = std::min(x0, x), x1 = std::max(x1, x);
    y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
  if (behind == 3) return {};
  if (behind > 0) return grid.rect;
  const auto clip = [](double value, int low, int high) {
    return static_cast<int>(std::clamp(value, double(low), double(high)));
  };
  const Rect& r = grid.rect;
  const double s = grid.shift;
  return {clip(std::ceil(x0 - s), r.x0, r.x1), clip(std::ceil(y0 - s), r.y0, r.y1),
          clip(std::floor(x1 + s) + 1, r.x0, r.x1), clip(std::floor(y1 + s) + 1, r.y0, r.y1)};
}

}  // namespace

std::optional<Triangle> set_up(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                               const SampleGrid& grid, Facing facing) {
  const std::array<glm::dvec3, 3> p = {glm::dvec3(a), glm::dvec3(b), glm::dvec3(c)};
  // The facing comes from the plane's normal, not from the box product, which suffers from
  // cancellation.
  const double volume = glm::dot(p[0], glm::cross(p[1] - p[0], p[2] - p[0]));
  if (!(std::abs(volume) > 0) || (facing == Facing::kFront && volume > 0)) return std::nullopt;
  Triangle out;
  out.box = box_of(p, grid);
  if (out.box.empty()) return std::nullopt;
  for (std::size_t i = 0; i < 3; ++i) {
    // Vertex i's share along the ray (x, y, 1) of a sample is ray . (next x last) / volume.
    const glm::dvec3 n = glm::cross(p[(i + 1) % 3], p[(i + 2) % 3]) / volume;
    const double dx = n.x / grid.focal.x, dy = n.y / grid.focal.y;
    const double first =
        dx * (out.box.x0 - grid.center.x) + dy * (out.box.y0 - grid.center.y) + n.z;
    out.share[i] = {static_cast<float>(dx), static_cast<float>(dy), static_cast<float>(first)};
  }
  return out;
}

}  // namespace mixrig::render::cpu
