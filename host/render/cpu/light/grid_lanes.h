// SPDX-License-Identifier: Apache-2.0
// Interpolates a grid of values at a register of points at a time.
#pragma once

#include "host/render/contract/passes.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {

/// Points in the cells of a grid, [z][y][x]; points outside are moved to its border.
class GridLanes {
 public:
  /// `p`: finite points in camera axes.
  GridLanes(const RoomShadeParams& grid, const VectorLanes& p)
      : cells_(grid.cells),
        x_(cell(grid, 0, p)),
        y_(cell(grid, 1, p)),
        z_(cell(grid, 2, p)),
        first_(x_.first + y_.first * cells_.x + z_.first * (cells_.x * cells_.y)) {}

  /// Whether each point lies inside the grid.
  IntLanes inside() const { return x_.inside & y_.inside & z_.inside; }
  /// Trilinear interpolation of the grid's values.
  FloatLanes read(const float* values) const {
    const FloatLanes a = along_y(values, 0), b = along_y(values, cells_.x * cells_.y);
    return a + (b - a) * z_.share;
  }

 private:
  /// Cell below a coordinate, and the fraction of the way to the next cell.
  struct Axis {
    IntLanes first, inside;
    FloatLanes share;
  };
  static Axis cell(const RoomShadeParams& grid, int axis, const VectorLanes& p) {
    const glm::mat4& m = grid.cell_from_camera;
    const FloatLanes at = p.x * m[0][axis] + p.y * m[1][axis] + p.z * m[2][axis] + m[3][axis];
    const int count = grid.cells[axis];
    const FloatLanes last_at = FloatLanes{} + static_cast<float>(count - 1);
    const FloatLanes inside = min(max(at, FloatLanes{}), last_at);
    const IntLanes whole = truncate(inside), last = IntLanes{} + std::max(count - 2, 0);
    const IntLanes first = whole > last ? last : whole;
    return {first, (at >= 0) & (at <= last_at), inside - to_float(first)};
  }
  FloatLanes along_x(const float* values, int offset) const {
    const FloatLanes a = gather(values, first_ + offset), b = gather(values, first_ + (offset + 1));
    return a + (b - a) * x_.share;
  }
  FloatLanes along_y(const float* values, int offset) const {
    const FloatLanes a = along_x(values, offset), b = along_x(values, offset + cells_.x);
    return a + (b - a) * y_.share;
  }

  glm::ivec3 cells_;
  Axis x_, y_, z_;
  IntLanes first_;
};

}  // namespace mixrig::render::cpu
