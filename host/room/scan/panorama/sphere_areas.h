// SPDX-License-Identifier: Apache-2.0
// Connected areas of a panorama.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

struct SphereArea {
  double solid_angle_sr = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< mean, of unit length
  std::vector<std::array<int, 2>> pixels;
  std::vector<std::array<int, 2>> border;  ///< neighbours outside of it; some more than once
  bool holds_marked = false;               ///< it contains the marked direction
};

/// Finds areas of connected pixels (by sides, columns go around) for which `is_part(x, y)` holds.
/// `is_joined(x, y, u, v)` says whether two neighbours are connected. `marked`: a direction, or
/// zero for none.
template <typename IsPart, typename IsJoined>
std::vector<SphereArea> areas_of(Size size, const Directions& directions,
                                 const Eigen::Vector3d& marked, const IsPart& is_part,
                                 const IsJoined& is_joined) {
  Image<std::uint8_t> part(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) part.row(y)[x] = is_part(x, y) ? 1 : 0;
  const double pixel_rad = std::numbers::pi / size.height;
  std::vector<SphereArea> areas;
  std::vector<std::array<int, 2>> open;
  for (int y0 = 0; y0 < size.height; ++y0)
    for (int x0 = 0; x0 < size.width; ++x0) {
      if (part.row(y0)[x0] != 1) continue;
      SphereArea area;
      open.assign(1, {x0, y0});
      part.row(y0)[x0] = 2;
      while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        area.pixels.push_back({x, y});
        const Eigen::Vector3d ray = directions(x, y);
        const double solid_sr = pixel_rad * pixel_rad * directions.across(y);
        area.solid_angle_sr += solid_sr;
        area.direction += solid_sr * ray;
        if (!marked.isZero() && ray.dot(marked) > std::cos(pixel_rad)) area.holds_marked = true;
        for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
          const int u = (x + dx + size.width) % size.width, v = y + dy;
          if (v < 0 || v >= size.height) continue;
          const bool joined = part.row(v)[u] != 0 && is_joined(x, y, u, v);
          if (!joined) area.border.push_back({u, v});
          if (!joined || part.row(v)[u] != 1) continue;
          part.row(v)[u] = 2;
          open.push_back({u, v});
        }
      }
      area.direction.normalize();
      areas.push_back(std::move(area));
    }
  return areas;
}

/// Finds areas whose neighbouring pixels are all connected.
template <typename IsPart>
std::vector<SphereArea> areas_of(Size size, const Directions& directions,
                                 const Eigen::Vector3d& marked, const IsPart& is_part) {
  return areas_of(size, directions, marked, is_part, [](int, int, int, int) { return true; });
}

}  // namespace mixrig::model
