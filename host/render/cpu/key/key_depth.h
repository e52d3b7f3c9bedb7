// SPDX-License-Identifier: Apache-2.0
// Pass key: fills the depth of people's pixels that have no measurement.
#pragma once

#include "hal/base/image.h"
#include "host/render/cpu/key/key.h"

namespace mixrig::render::cpu {

/// Gives each pixel of a block that votes gave to people the inverse depth of the nearest
/// foreground along its row and column. Where the nearer of two surfaces hides the place from the
/// ToF camera, the rear one is taken. Writes only pixels that are not foreground and reads only
/// others, so that blocks may be filled in parallel.
void fill_depth(const KeyInput& input, const KeyScratch& scratch, int bx, int by,
                const Image<std::uint8_t>& matte, Image<float>& view_w);

}  // namespace mixrig::render::cpu
