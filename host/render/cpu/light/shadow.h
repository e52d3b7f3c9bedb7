// SPDX-License-Identifier: Apache-2.0
// Pass shadow: depth maps of the casters, as seen from each lamp.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/virtual/raster.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Side in texels of a cell of `ShadowMap::largest`.
inline constexpr int kCellTexels = 8;

/// Shadow map of one lamp; empty for a lamp without shadow.
struct ShadowMap {
  Image<float> w;  ///< inverse depth of the nearest caster from the lamp, 1/m; 0: none
  Rect drawn;      ///< texels outside are 0
  /// [k](x, y): the largest w in 2^k x 2^k cells from cell (x, y) on, clipped at the border.
  std::vector<Image<float>> largest;
  bool empty() const { return w.empty(); }
};

/// Draws the casters into the map of every lamp whose map_size_texel is not 0.
void draw_shadow_maps(Crew& crew, const FrameParams& params, std::vector<ShadowMap>& maps);

/// Fills `largest` from `w` within `drawn`; draw_shadow_maps() calls it.
void find_largest(ShadowMap& map);

/// Upper bound of w over the texels in [x0, x1] x [y0, y1], by four look-ups: exceeds the largest w
/// where the rectangle is far from square or ends within a cell. Texels outside are 0.
float largest_w(const ShadowMap& map, float x0, float y0, float x1, float y1);

}  // namespace mixrig::render::cpu
