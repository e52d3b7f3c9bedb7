// SPDX-License-Identifier: Apache-2.0
// Maps the floor of a room from above: what stands on it, and where it is free.
#include "extras/people/plan/floor_map.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace mixrig::plan {
namespace {

constexpr float kOnFloor_m = 0.06F;  ///< noise of the floor
constexpr float kStanding_m = 2.0F;
constexpr float kFarthest_m = 20;
constexpr double kLeastShare = 0.05;  ///< of a cell's points, for something to stand there
constexpr int kLeastPoints = 2;

struct Cell {
  int floor = 0, above = 0;
  float top_m = 0, seen_m = -1;
};

/// Closes gaps between points of a floor that is seen from far away: unknown cells with free floor
/// around.
void close_gaps(Image<float>& top_m) {
  constexpr int kMostly = 5;  // of eight
  const Image<float> before = top_m;
  for (int y = 1; y + 1 < top_m.height(); ++y)
    for (int x = 1; x + 1 < top_m.width(); ++x) {
      if (before.at(x, y) != FloorMap::kUnknown) continue;
      int free = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) free += before.at(x + i, y + j) == 0 ? 1 : 0;
      if (free >= kMostly) top_m.at(x, y) = 0;
    }
}

}  // namespace

double FloorMap::free_m2() const {
  double cells = 0;
  for (int y = 0; y < size().height; ++y)
    cells += static_cast<double>(std::count(top_m.row(y), top_m.row(y) + size().width, 0.0F));
  return cells * cell_m * cell_m;
}

FloorMap map_floor(std::span<const RoomPoint> points, double cell_m) {
  FloorMap map;
  map.cell_m = cell_m;
  const auto counts = [&](const RoomPoint& p) {
    return p.at_m.z() > -kOnFloor_m && p.at_m.z() < kStanding_m &&
           (p.at_m - points.front().at_m).norm() < kFarthest_m;
  };
  Eigen::AlignedBox2f box;
  for (const RoomPoint& p : points)
    if (counts(p)) box.extend(p.at_m.head<2>());
  if (box.isEmpty()) return map;
  map.corner_m = box.min().cast<double>().array() - 1.5 * cell_m;  // unknown cells around
  const Eigen::Vector2i cells = (box.sizes() / static_cast<float>(cell_m)).cast<int>();
  const Size size{cells.x() + 4, cells.y() + 4};
  map.top_m.reset(size, FloorMap::kUnknown);
  map.color.reset(size, Rgb8{255, 255, 255});
  std::vector<Cell> seen(static_cast<std::size_t>(size.area()));
  for (const RoomPoint& p : points) {
    if (!counts(p)) continue;
    const Eigen::Vector2i at = map.cell_of(p.at_m.head<2>().cast<double>());
    if (!map.contains(at)) continue;
    Cell& cell = seen[static_cast<std::size_t>(at.y() * size.width + at.x())];
    const float z = p.at_m.z();
    (z < kOnFloor_m ? cell.floor : cell.above) += 1;
    cell.top_m = std::max(cell.top_m, z);
    if (z > cell.seen_m) cell.seen_m = z, map.color.at(at.x(), at.y()) = p.color;
  }
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Cell& cell = seen[static_cast<std::size_t>(y * size.width + x)];
      if (cell.floor + cell.above == 0) continue;
      const bool stands =
          cell.above >= kLeastPoints && cell.above > kLeastShare * (cell.floor + cell.above);
      map.top_m.at(x, y) = stands ? cell.top_m : cell.floor > 0 ? 0 : FloorMap::kUnknown;
    }
  close_gaps(map.top_m);
  return map;
}

Image<std::uint8_t> not_free(const FloorMap& map) {
  Image<std::uint8_t> blocked(map.size());
  for (int y = 0; y < map.size().height; ++y)
    for (int x = 0; x < map.size().width; ++x) blocked.at(x, y) = map.top_m.at(x, y) == 0 ? 0 : 255;
  return blocked;
}

Image<std::uint8_t> grown(const Image<std::uint8_t>& blocked, double distance_cells) {
  Image<std::uint8_t> out(blocked.size());
  const Size size = blocked.size();
  const int reach = static_cast<int>(std::ceil(distance_cells));
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      if (blocked.at(x, y) == 0) continue;
      for (int j = std::max(0, y - reach); j <= std::min(size.height - 1, y + reach); ++j)
        for (int i = std::max(0, x - reach); i <= std::min(size.width - 1, x + reach); ++i)
          if (std::hypot(i - x, j - y) <= distance_cells) out.at(i, j) = 255;
    }
  return out;
}

double open_m2(const FloorMap& map, double margin_m) {
  const Image<std::uint8_t> blocked = grown(not_free(map), margin_m / map.cell_m);
  int cells = 0;
  for (int y = 0; y < blocked.height(); ++y)
    for (int x = 0; x < blocked.width(); ++x) cells += blocked.at(x, y) == 0 ? 1 : 0;
  return cells * map.cell_m * map.cell_m;
}

}  // namespace mixrig::plan
