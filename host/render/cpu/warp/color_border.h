// SPDX-License-Identifier: Apache-2.0
// Finds the border between two ToF samples by the plate's colours.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/plate/srgb.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Border of the nearer of two neighbouring samples, on the way to the other one.
struct ColorBorder {
  float at = 0;    ///< place, in halves of a ToF pixel past the nearer sample
  float sure = 0;  ///< confidence; 0: the colours do not tell, 1: they decide alone
};

/// Borders on the links to the right of and below each ToF pixel. Entries of links that hold, or
/// lie between two unknown pixels, are not written.
struct ColorBorders {
  explicit ColorBorders(Size tof_size) : right(tof_size), down(tof_size) {}
  const ColorBorder& of(int x, int y, int dx, int dy) const {
    if (dx != 0) return right.row(y)[dx < 0 ? x - 1 : x];
    return down.row(dy < 0 ? y - 1 : y)[x];
  }
  Image<ColorBorder> right, down;
};

/// Finds the borders by `plate`, which lies in the view.
void find_color_borders(Crew& crew, const WarpParams& params, const Image<glm::vec2>& tof_ray,
                        const TofGrid& grid, const Image<Rgbx16>& plate, ColorBorders& out);

/// Depths of pixel (x, y) and its neighbour, which have no link, by the samples behind them, which
/// saw one surface each; 0 where unknown.
struct DepthsAtBorder {
  float own_m, other_m;
};
DepthsAtBorder depths_at_border(const TofGrid& grid, int x, int y, int dx, int dy);

/// Whether two neighbours along x or y are linked.
inline bool linked(const TofGrid& grid, int x, int y, int dx, int dy) {
  const int from_x = dx < 0 ? x - 1 : x, from_y = dy < 0 ? y - 1 : y;
  return grid.links.row(from_y + kFrame)[from_x + kFrame] & (dx != 0 ? kRight : kDown);
}

}  // namespace mixrig::render::cpu
