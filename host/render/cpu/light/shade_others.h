// SPDX-License-Identifier: Apache-2.0
// Pass light: surfaces that pixels of objects show beside their nearest one (OtherSurface).
#pragma once

#include "host/render/cpu/light/light_parts.h"

namespace mixrig::render::cpu {

/// Shades the other surfaces in a rectangle and adds them to the layer's colour.
void shade_others(const LightInput& input, const Rect& rect, VirtualLayer& layer);

/// Adds the other surfaces as they are lit past people (`people`). Call it after shade_others(),
/// with a colour that does not contain them.
void add_others_past_people(const LightInput& input, const PeopleMaps& people, const Rect& rect,
                            VirtualLayer& layer);

}  // namespace mixrig::render::cpu
