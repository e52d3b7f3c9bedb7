// SPDX-License-Identifier: Apache-2.0
// Pass key: fills the depth of people's pixels that have no measurement.
#pragma once

#include "hal/base/image.h"
#include "host/render/cpu/key/key.h"

namespace mixrig::render::cpu {

/// Marks foreground of a block in `scratch.alone` that a cut cell drew and that whole cells on its
/// row and column contradict: a sample that measures a limb and what lies behind it has the depth
/// of neither.
void find_alone(const KeyInput& input, int bx, int by, const Image<std::uint8_t>& matte,
                const Image<float>& view_w, KeyScratch& scratch);

/// Gives each pixel of a block that votes gave to people, and that is no foreground or alone, the
/// inverse depth of the nearest foreground of whole cells along its row and column. Where the
/// nearer of two surfaces hides the place from the ToF camera, the rear one is taken. Reads only
/// pixels of whole cells and writes only others, so that blocks may be filled in parallel.
void fill_depth(const KeyInput& input, const KeyScratch& scratch, int bx, int by,
                const Image<std::uint8_t>& matte, Image<float>& view_w);

}  // namespace mixrig::render::cpu
