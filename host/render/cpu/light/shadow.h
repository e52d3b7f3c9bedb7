// SPDX-License-Identifier: Apache-2.0
// Pass shadow: depth maps of the casters from each lamp.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/virtual/raster.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Side of a cell of texels, over which `ShadowMap::largest` is known.
inline constexpr int kCellTexels = 8;

/// What a lamp's casters hide. Empty for a lamp without shadow.
struct ShadowMap {
  Image<float> w;  ///< inverse lamp depth of the nearest caster, 1/m; 0 none
  Rect drawn;      ///< texels outside hold 0
  /// [k](x, y): the largest w in 2^k x 2^k cells from cell (x, y) on, cut off at the border.
  std::vector<Image<float>> largest;
  bool empty() const { return w.empty(); }
};

/// Draws the casters into the map of every lamp whose map_size_texel is not 0.
void draw_shadow_maps(Crew& crew, const FrameParams& params, std::vector<ShadowMap>& maps);

/// Fills `largest` from `w` within `drawn`; draw_shadow_maps has done it.
void find_largest(ShadowMap& map);

/// At least the largest w of the texels in [x0, x1] x [y0, y1], by four look-ups: never less, more
/// where the rectangle is far from a square or ends within a cell. Texels outside hold 0.
float largest_w(const ShadowMap& map, float x0, float y0, float x1, float y1);

}  // namespace mixrig::render::cpu
