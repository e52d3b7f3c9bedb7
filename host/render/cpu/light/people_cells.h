// SPDX-License-Identifier: Apache-2.0
// Pass light: what people hide of the lamps at the corners of cells of 8x8 pixels. Over a cell of
// one smooth surface pixels take what lies between.
#pragma once

#include <span>

#include "host/render/cpu/light/cells.h"

namespace mixrig::render::cpu {

/// Shares of the lamps that the corners of a tile's cells see past people.
class PeopleCells {
 public:
  /// `at`: the corners. Preconditions: blur_allows_cells(); at most kMostLamps maps.
  PeopleCells(const PeopleMaps& people, std::span<const SurfaceLanes> at);
  bool hide_any() const { return hide_any_; }
  /// Whether people hide any of a lamp from a corner of the cell.
  bool hide(const CellOf& c) const;
  /// Whether what they hide of one changes too much over the cell to be taken from its corners.
  bool change(const CellOf& c) const;
  /// Of all whole lamps, as many as there are maps; 1 of those that no person may hide.
  std::span<const CornerValues> seen() const { return std::span(seen_).first(count_); }
  /// The same of the corners of register `i`.
  void seen_of_register(std::size_t i, std::span<FloatLanes> out) const;

 private:
  std::size_t count_;
  LampSet maybe_;
  bool hide_any_ = false;
  std::array<CornerValues, kMostLamps> seen_;
};

/// Floats of a row of LightLayer::corners, for so many whole lamps.
std::size_t corner_floats(std::size_t lamps);

/// Whether what people hide of the lamps in doubt may be taken from corners of cells: from lamps
/// that are wide beside a cell, or where blur_allows_cells().
bool people_allow_cells(const PinholeParams& view, const PeopleMaps& people, const Rect& tile,
                        float near_m, float far_m);

/// Light of a whole tile of the background that objects shade, past people: the place of a shadow
/// within a cell is that of the light without people, `light.background`. `known` and `kept`: of
/// the tile, found in the first frame in which people hide anything of it. Preconditions:
/// people_allow_cells(); at most kMostLamps maps.
void light_cells_past_people(const LightInput& input, const Doubt& doubt, const PeopleMaps& people,
                             ImageView<const float> depth_m, const Rect& tile,
                             BackgroundTile& known, float* kept, LightLayer& light);

}  // namespace mixrig::render::cpu
