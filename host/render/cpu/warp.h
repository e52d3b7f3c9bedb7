// SPDX-License-Identifier: Apache-2.0
// Pass warp: the ToF grid as a mesh in the view, nearest surface first.
#pragma once

#include <bit>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/correct.h"
#include "host/render/prepare.h"

namespace mixrig::render::cpu {

/// Inverse depth whose lowest bit says that a cut cell drew it: one word a pixel, one maximum.
inline bool from_cut_cell(float w) { return std::bit_cast<std::uint32_t>(w) & 1U; }
inline float with_cut_flag(float w, bool cut) {
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(w) & ~1U) | (cut ? 1U : 0U));
}

/// Vertices of the mesh in the view, and what bands need to find their cells.
struct WarpScratch {
  explicit WarpScratch(Size tof_size);
  struct RowSpan {  ///< rows of the view that a run of cells may touch
    float v_min, v_max;
  };
  Image<float> u_px, v_px, w;  ///< of each ToF pixel in the view; w 0: unknown
  std::vector<RowSpan> spans;  ///< [cell row][run of kRunCells]
  int runs = 0;                ///< a row
};
inline constexpr int kRunCells = 32;

/// Blocks of 4x4 pixels are written whole: the view's image has this margin to the right and below.
inline constexpr int kViewMargin = 3;

/// Fills the view with the inverse depth of the nearest surface, 0 unknown. `view_w` is
/// kViewMargin wider and higher than the view.
void warp(Crew& crew, const Tables& tables, const TofGrid& grid, WarpScratch& scratch,
          Image<float>& view_w);

}  // namespace mixrig::render::cpu
