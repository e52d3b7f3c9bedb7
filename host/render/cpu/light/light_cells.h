// SPDX-License-Identifier: Apache-2.0
// Light of the background, sampled as coarsely as the blur of shadows allows: at the corners of
// cells of 8x8 pixels, interpolated over flat cells. Lamps that change much over a cell are
// evaluated at each pixel.
#pragma once

#include "host/render/cpu/light/cells.h"

namespace mixrig::render::cpu {

/// Computes the light of a background tile; `light` must hold it as lit. Preconditions: the whole
/// tile lies in the view; blur_allows_cells(); at most kMostLamps maps.
void light_in_cells(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m,
                    const Rect& tile, Image<std::uint16_t>& light);

/// Computes the light of a background tile at every pixel, with any blur and any number of lamps.
void light_exactly(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m,
                   const Rect& tile, Image<std::uint16_t>& light);

}  // namespace mixrig::render::cpu
