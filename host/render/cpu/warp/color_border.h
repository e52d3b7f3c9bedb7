// SPDX-License-Identifier: Apache-2.0
// Where the plate's colours say that the border between two ToF samples lies.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/plate/srgb.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// The border of the nearer of two neighbouring samples, towards the other one.
struct ColorBorder {
  float at = 0;    ///< halves of a step past the nearer sample
  float sure = 0;  ///< 0: the plate does not tell, 1: it tells all
};

/// Of the links to the right and down of each ToF pixel. Those that hold, or between two unknown
/// pixels, are left as they are.
struct ColorBorders {
  explicit ColorBorders(Size tof_size) : right(tof_size), down(tof_size) {}
  const ColorBorder& of(int x, int y, int dx, int dy) const {
    if (dx != 0) return right.row(y)[dx < 0 ? x - 1 : x];
    return down.row(dy < 0 ? y - 1 : y)[x];
  }
  Image<ColorBorder> right, down;
};

/// By `plate`, in the view.
void find_color_borders(Crew& crew, const WarpParams& params, const Image<glm::vec2>& tof_ray,
                        const TofGrid& grid, const Image<Rgbx16>& plate, ColorBorders& out);

/// Depths of pixel (x, y) and its neighbour, which have no link, by the samples behind them, which
/// saw one surface; 0 where unknown.
struct DepthsAtBorder {
  float own_m, other_m;
};
DepthsAtBorder depths_at_border(const TofGrid& grid, int x, int y, int dx, int dy);

/// Whether two neighbours along x or y lie on one surface.
inline bool linked(const TofGrid& grid, int x, int y, int dx, int dy) {
  const int from_x = dx < 0 ? x - 1 : x, from_y = dy < 0 ? y - 1 : y;
  return grid.links.row(from_y + kFrame)[from_x + kFrame] & (dx != 0 ? kRight : kDown);
}

}  // namespace mixrig::render::cpu
