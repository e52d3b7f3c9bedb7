// SPDX-License-Identifier: Apache-2.0
// Light of the background at the rate that its blur allows: shadows are found at the corners of
// cells of 8x8 pixels, and over a cell of a flat surface pixels take what lies between. Lamps that
// change much over the cell are looked up for each pixel.
#pragma once

#include "host/render/cpu/light/cells.h"

namespace mixrig::render::cpu {

/// Light of a tile of the background, which `light` holds as lit. Preconditions: the whole tile
/// lies in the view; blur_allows_cells(); at most kMostLamps maps.
void light_in_cells(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m,
                    const Rect& tile, Image<std::uint16_t>& light);

/// The same, each pixel by itself: whatever the blur, and with any number of lamps.
void light_exactly(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m,
                   const Rect& tile, Image<std::uint16_t>& light);

}  // namespace mixrig::render::cpu
