// SPDX-License-Identifier: Apache-2.0
// Maps the floor of a room from above: what stands on it, and where it is free.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::plan {

/// A point of the empty room, world axes with z up and the floor at 0.
struct RoomPoint {
  Eigen::Vector3f at_m;
  Rgb8 color;
};

/// Cells of the floor; column x and row y hold the world's x and y from the corner on.
struct FloorMap {
  static constexpr float kUnknown = -1;
  double cell_m = 0.05;
  Eigen::Vector2d corner_m = Eigen::Vector2d::Zero();
  Image<float> top_m;  ///< height of what stands there; 0: free floor; kUnknown: never seen
  Image<Rgb8> color;   ///< seen from above, without what hangs high; white where unknown

  Size size() const { return top_m.size(); }
  Eigen::Vector2d middle_m(int x, int y) const {
    return corner_m + cell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
  }
  /// Cell of a point; it may lie outside the map.
  Eigen::Vector2i cell_of(const Eigen::Vector2d& at_m) const {
    return ((at_m - corner_m) / cell_m).array().floor().cast<int>();
  }
  bool contains(const Eigen::Vector2i& cell) const {
    return cell.x() >= 0 && cell.y() >= 0 && cell.x() < size().width && cell.y() < size().height;
  }
  double free_m2() const;
};

/// Maps the floor. Only points up to the height of a standing person count; a cell is free where
/// nearly all of its points lie on the floor. Empty where there is no point within 20 m of the
/// first one. Pure.
FloorMap map_floor(std::span<const RoomPoint> points, double cell_m = 0.05);

/// Mask: 255 where a cell is within `distance_cells` of a cell that is not 0, else 0. Pure.
Image<std::uint8_t> grown(const Image<std::uint8_t>& blocked, double distance_cells);
/// Mask: 255 where the floor is not free or not known, else 0. Pure.
Image<std::uint8_t> not_free(const FloorMap& map);
/// Area of the free floor farther than a margin from everything that is not free. Pure.
double open_m2(const FloorMap& map, double margin_m);

}  // namespace mixrig::plan
