// SPDX-License-Identifier: Apache-2.0
// Depth of field: the composite as a thin lens sees it, gathered in three layers.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/render/compositor.h"

namespace mixrig::render::cpu {

/// Memory that frames reuse.
struct FocusScratch {
  /// One value a pixel, with a margin of `margin` all around.
  struct Plane {
    std::vector<float> values;
    std::size_t stride = 0;
    int margin = 0;
    void reset(Size size, int margin_px);
    float* row(int y) {
      return values.data() + static_cast<std::size_t>(y + margin) * stride +
             static_cast<std::size_t>(margin);
    }
    const float* row(int y) const { return const_cast<Plane*>(this)->row(y); }
  };
  Plane r, g, b;    ///< linear light, 1 = white
  Plane w;          ///< 1/z; of a pixel without depth that of its row's neighbour
  Plane radius_px;  ///< of the disc; margins have none
  Plane share;      ///< 1 / (pixels that the disc covers); 0 in the margins
  std::vector<float> tile_radius_px, near_radius_px;  ///< greatest of a tile, and of those about it
  std::vector<float> disc_area;                       ///< by radius, in steps of 1/16 px
  float focus_w = 0;                                  ///< of the last frame whose focus was known
};

/// Replaces output.color by what a lens of focal length `fx_px` sees, by output.mixed_depth_m.
/// Each pixel is the sum of what lies before its surface (discs that reach it), its surface, and
/// what lies behind it: light of what is behind never spreads over what is sharp before it, and
/// what is blurred before spreads over what is sharp behind. What a surface hides is taken from
/// beside it. Does not allocate after the first frame.
void draw_focus(Crew& crew, const Focus& focus, double fx_px, FocusScratch& scratch,
                FrameOutput& output);

}  // namespace mixrig::render::cpu
