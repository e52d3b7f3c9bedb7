// SPDX-License-Identifier: Apache-2.0
// Pass light: what people hide of the lamps at the corners of cells of 8x8 pixels, interpolated
// over cells of one smooth surface.
#pragma once

#include <span>

#include "host/render/cpu/light/cells.h"

namespace mixrig::render::cpu {

/// Shares of the lamps that the corners of a tile's cells see past people.
class PeopleCells {
 public:
  /// `at`: surface points of the corners. Preconditions: blur_allows_cells(); at most kMostLamps
  /// maps.
  PeopleCells(const PeopleMaps& people, std::span<const SurfaceLanes> at);
  bool hide_any() const { return hide_any_; }
  /// Whether people hide part of any lamp from a corner of the cell.
  bool hide(const CellOf& c) const;
  /// Whether the hidden part of some lamp changes too much over the cell to be interpolated.
  bool change(const CellOf& c) const;
  /// Visible shares of all whole lamps, as many as there are maps; 1 for lamps that no person may
  /// hide.
  std::span<const CornerValues> seen() const { return std::span(seen_).first(count_); }
  /// Writes those shares for the corners of register `i`.
  void seen_of_register(std::size_t i, std::span<FloatLanes> out) const;

 private:
  std::size_t count_;
  LampSet maybe_;
  bool hide_any_ = false;
  std::array<CornerValues, kMostLamps> seen_;
};

/// Floats in a row of LightLayer::corners for `lamps` whole lamps.
std::size_t corner_floats(std::size_t lamps);

/// Whether people's shadows of the lamps in doubt may be interpolated between corners of cells:
/// each lamp is wide compared with a cell, or blur_allows_cells() holds.
bool people_allow_cells(const PinholeParams& view, const PeopleMaps& people, const Rect& tile,
                        float near_m, float far_m);

/// Computes, past people, the light of a whole background tile that objects shade. Within a cell
/// the shadow keeps the place that it has without people, in `light.background`. `known` and `kept`
/// belong to the tile and are filled in the first frame in which people hide any of its light.
/// Preconditions: people_allow_cells(); at most kMostLamps maps.
void light_cells_past_people(const LightInput& input, const Doubt& doubt, const PeopleMaps& people,
                             ImageView<const float> depth_m, const Rect& tile,
                             BackgroundTile& known, float* kept, LightLayer& light);

}  // namespace mixrig::render::cpu
