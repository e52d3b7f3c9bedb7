// SPDX-License-Identifier: Apache-2.0
// Shadows at the rate that their blur allows: they are found at the corners of cells of 8x8 pixels;
// where they change little over a cell of a smooth surface, its pixels take what lies between.
#pragma once

#include <array>
#include <cstdint>

#include "host/render/cpu/light_parts.h"

namespace mixrig::render::cpu {

inline constexpr int kCellPx = 8;
inline constexpr int kCellsAcross = kLitTileWidth / kCellPx, kCellsDown = kLitTileHeight / kCellPx;
/// Of the share of a lamp, or of light, over a cell: more than a tap of a filter.
inline constexpr float kMostChange = 0.1F;

inline constexpr std::size_t kCornersPadded =
    ((kCellsAcross + 1) * (kCellsDown + 1) + kLanes - 1) / kLanes * kLanes;
/// Values at the corners of a tile's cells, row by row.
struct alignas(64) CornerValues : std::array<float, kCornersPadded> {};

/// Whether every lamp in doubt is so wide that casters are found from further away than over a
/// cell: else a narrow shadow could lie between corners.
bool blur_allows_cells(const LightInput& input, LampSet maybe, const Rect& tile, float near_m,
                       float far_m);

/// Light of a tile of the background, which `light` holds as lit. Precondition: the whole tile lies
/// in the view.
void light_in_cells(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m,
                    const Rect& tile, Image<std::uint16_t>& light);

/// What virtual surfaces of a tile see of the lamps in doubt.
class VirtualCells {
 public:
  VirtualCells(const LightInput& input, LampSet maybe, const Rect& tile, const VirtualLayer& layer);
  bool any_smooth() const { return smooth_ != 0; }
  /// Whether the pixel lies in a smooth cell.
  bool is_smooth(int x, int y) const {
    return smooth_ & bit((x - tile_.x0) / kCellPx, (y - tile_.y0) / kCellPx);
  }
  /// Share of a lamp in doubt at places of smooth cells.
  FloatLanes share(std::size_t lamp, FloatLanes x, FloatLanes y) const;

 private:
  static unsigned bit(int column, int row) { return 1U << (row * kCellsAcross + column); }
  void find_flat(const LightInput& input, const VirtualLayer& layer);
  void find_shares(const LightInput& input, LampSet maybe);

  static constexpr std::size_t kRegisters = kCornersPadded / kLanes;
  Rect tile_;
  unsigned smooth_ = 0;  ///< cells
  std::array<SurfaceLanes, kRegisters> at_;
  std::array<CornerValues, kMostLamps> shares_;
};

}  // namespace mixrig::render::cpu
