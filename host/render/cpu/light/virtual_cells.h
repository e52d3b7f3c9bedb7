// SPDX-License-Identifier: Apache-2.0
// Shares of the lamps that virtual surfaces of a tile see, at the corners of cells of 8x8 pixels,
// interpolated over cells of a smooth surface.
#pragma once

#include <span>

#include "host/render/cpu/light/cells.h"

namespace mixrig::render::cpu {

/// Surface points at the corners, and which cells show one smooth surface.
class VirtualCorners {
 public:
  static constexpr std::size_t kRegisters = kCornersPadded / kLanes;
  VirtualCorners(const PinholeParams& view, const Rect& tile, const VirtualLayer& layer);
  bool any_smooth() const { return smooth_ != 0; }
  bool is_smooth(int column, int row) const { return (smooth_ & bit(column, row)) != 0; }
  /// Surface points; a corner that is not covered has normal 0, so that no lamp lights it.
  const std::array<SurfaceLanes, kRegisters>& at() const { return at_; }

 private:
  static unsigned bit(int column, int row) { return 1U << (row * kCellsAcross + column); }
  std::array<SurfaceLanes, kRegisters> at_;
  unsigned smooth_ = 0;  ///< one bit a cell
};

class VirtualCells {
 public:
  /// Precondition: at most kMostLamps maps.
  VirtualCells(const LightInput& input, LampSet maybe, const Rect& tile, const VirtualLayer& layer);
  bool is_smooth(int column, int row) const { return corners_.is_smooth(column, row); }
  /// Lamps in doubt that change too much over a smooth cell to be interpolated.
  LampSet lamps_to_find(int column, int row) const;
  /// Writes the share of each lamp at places (x, y) of a smooth cell: visible past the real room
  /// and, for lamps not in `to_find`, past the objects.
  void shares(int column, int row, LampSet to_find, FloatLanes x, FloatLanes y,
              std::span<FloatLanes> out) const;

 private:
  void find_shares(const LightInput& input, LampSet maybe);

  Rect tile_;
  VirtualCorners corners_;
  LampSet maybe_;
  std::size_t count_;                            ///< number of lamps
  std::array<CornerValues, kMostLamps> weight_;  ///< of each lamp in all light, without shadows
  std::array<CornerValues, kMostLamps> seen_;  ///< visible past objects and room; of lamps in doubt
  std::array<CornerValues, kMostLamps> in_room_;  ///< visible past the room
};

}  // namespace mixrig::render::cpu
