// SPDX-License-Identifier: Apache-2.0
// Pass warp: the ToF grid as a mesh in the view, nearest surface first.
#pragma once

#include <bit>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/warp/color_border.h"
#include "host/render/cpu/warp/draw_quads.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// The lowest bit of an inverse depth is set where a cut cell drew it: the test for the nearest
/// surface stays one maximum of one word.
inline bool from_cut_cell(float w) { return std::bit_cast<std::uint32_t>(w) & 1U; }

/// Vertices of the mesh in the view, and what bands need to find their cells.
struct WarpScratch {
  /// `by_plate`: warp() is given a plate.
  explicit WarpScratch(Size tof_size, bool by_plate = false);
  struct RowSpan {  ///< rows of the view that a run of cells may touch
    float v_min, v_max;
  };
  Size size;                   ///< of the ToF picture
  Image<float> u_px, v_px, w;  ///< of each ToF pixel in the view; w 0: unknown; rows are padded
  std::vector<RowSpan> spans;  ///< [cell row][run of kRunCells]
  ColorBorders colors;         ///< empty where no plate is given
  int runs = 0;                ///< a row
};
inline constexpr int kRunCells = QuadBatch::kCapacity;

/// What the view holds before.
enum class Before { kNothing, kSurfaces };

/// Fills the view with the inverse depth of the nearest surface, 0 unknown; `before` may be that of
/// other grids. `view_w` is kViewMargin wider and higher than the view. Borders lie where the
/// colours of `plate` (of the view) change, where `scratch` is made for that; null: it is not
/// known.
void warp(Crew& crew, const Tables& tables, const TofGrid& grid, WarpScratch& scratch,
          Image<float>& view_w, Before before = Before::kNothing,
          const Image<Rgbx16>* plate = nullptr);

}  // namespace mixrig::render::cpu
