// SPDX-License-Identifier: Apache-2.0
// Pass shadow: depth maps of the casters from each lamp, and the share of a lamp that a point sees.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/raster.h"
#include "host/render/prepare.h"

namespace mixrig::render::cpu {

/// Inverse lamp depth of the nearest caster, 0 none. Empty for a lamp without shadow.
using ShadowMap = Image<float>;

/// Draws the casters into the map of every lamp whose map_size_texel is not 0.
void draw_shadow_maps(Crew& crew, const FrameParams& params, std::vector<ShadowMap>& maps);

/// Share of the lamp that a point sees past the casters, 0..1 (percentage-closer soft shadows,
/// Fernando 2005). `position_m`, `normal`: camera axes.
float visibility(const LampParams& lamp, const ShadowMap& map, const glm::vec3& position_m,
                 const glm::vec3& normal);

}  // namespace mixrig::render::cpu
