// SPDX-License-Identifier: Apache-2.0
// Pass light: what pixels of objects show beside their nearest surface (OtherSurface).
#pragma once

#include "host/render/cpu/light/light_parts.h"

namespace mixrig::render::cpu {

/// Shades the other surfaces of a rectangle's pixels and adds them to the layer's colour.
void shade_others(const LightInput& input, const Rect& rect, VirtualLayer& layer);

/// Adds them to the colour as they are past people, of which `people` tells. After shade_others(),
/// with a colour that they are not in.
void add_others_past_people(const LightInput& input, const PeopleMaps& people, const Rect& rect,
                            VirtualLayer& layer);

}  // namespace mixrig::render::cpu
