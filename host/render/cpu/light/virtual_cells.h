// SPDX-License-Identifier: Apache-2.0
// What virtual surfaces of a tile see of the lamps, at the corners of cells of 8x8 pixels; over a
// cell of a smooth surface it lies between.
#pragma once

#include <span>

#include "host/render/cpu/light/cells.h"

namespace mixrig::render::cpu {

/// What the tile shows at the corners, and which cells show one smooth surface.
class VirtualCorners {
 public:
  static constexpr std::size_t kRegisters = kCornersPadded / kLanes;
  VirtualCorners(const PinholeParams& view, const Rect& tile, const VirtualLayer& layer);
  bool any_smooth() const { return smooth_ != 0; }
  bool is_smooth(int column, int row) const { return (smooth_ & bit(column, row)) != 0; }
  /// No lamp lights a corner that is not covered.
  const std::array<SurfaceLanes, kRegisters>& at() const { return at_; }

 private:
  static unsigned bit(int column, int row) { return 1U << (row * kCellsAcross + column); }
  std::array<SurfaceLanes, kRegisters> at_;
  unsigned smooth_ = 0;  ///< cells
};

class VirtualCells {
 public:
  /// Precondition: at most kMostLamps maps.
  VirtualCells(const LightInput& input, LampSet maybe, const Rect& tile, const VirtualLayer& layer);
  bool is_smooth(int column, int row) const { return corners_.is_smooth(column, row); }
  /// Lamps in doubt that change too much over a smooth cell to be taken from its corners: the
  /// others change its light by kMostChange together.
  LampSet lamps_to_find(int column, int row) const;
  /// Share of each lamp at places (x, y) of a smooth cell, past the real room and, of all lamps but
  /// `to_find`, past the objects.
  void shares(int column, int row, LampSet to_find, FloatLanes x, FloatLanes y,
              std::span<FloatLanes> out) const;

 private:
  void find_shares(const LightInput& input, LampSet maybe);

  Rect tile_;
  VirtualCorners corners_;
  LampSet maybe_;
  std::size_t count_;                             ///< of lamps
  std::array<CornerValues, kMostLamps> weight_;   ///< of all light, without shadows
  std::array<CornerValues, kMostLamps> seen_;     ///< past objects and room; of lamps in doubt
  std::array<CornerValues, kMostLamps> in_room_;  ///< past the room
};

}  // namespace mixrig::render::cpu
