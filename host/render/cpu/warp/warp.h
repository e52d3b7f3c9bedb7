// SPDX-License-Identifier: Apache-2.0
// Pass warp: draws the ToF grid as a mesh into the view, nearest surface kept.
#pragma once

#include <bit>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/warp/draw_quads.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Whether a cut cell drew a pixel. The lowest bit of its inverse depth says so: then the test for
/// the nearest surface is one maximum of one word.
inline bool from_cut_cell(float w) { return std::bit_cast<std::uint32_t>(w) & 1U; }

/// Vertices of the mesh in the view, and the rows that bands need to find their cells.
struct WarpScratch {
  explicit WarpScratch(Size tof_size);
  struct RowSpan {  ///< view rows that a run of cells may touch
    float v_min, v_max;
  };
  Size size;                   ///< of the ToF picture
  Image<float> u_px, v_px, w;  ///< of each ToF pixel in the view; w 0: unknown; rows are padded
  std::vector<RowSpan> spans;  ///< [cell row][run of kRunCells]
  int runs = 0;                ///< runs a cell row
};
inline constexpr int kRunCells = QuadBatch::kCapacity;

/// Content of the view before warp().
enum class Before { kNothing, kSurfaces };

/// Fills the view with the inverse depth of the nearest surface, 0 unknown; with Before::kSurfaces
/// it keeps nearer surfaces of other grids. `view_w` is kViewMargin wider and higher than the view.
void warp(Crew& crew, const Tables& tables, const TofGrid& grid, WarpScratch& scratch,
          Image<float>& view_w, Before before = Before::kNothing);

}  // namespace mixrig::render::cpu
