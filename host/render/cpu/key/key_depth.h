// SPDX-License-Identifier: Apache-2.0
// Pass key: the depth of people's pixels that have none of their own.
#pragma once

#include "hal/base/image.h"
#include "host/render/cpu/key/key.h"

namespace mixrig::render::cpu {

/// For pixels of the block that votes gave to people: the inverse depth of the foreground that is
/// nearest in the picture along rows and columns; of two that lie so far apart as the nearer one
/// hides from the ToF camera, the rear one. Writes pixels that are not foreground and reads others,
/// so that blocks may be filled at once.
void fill_depth(const KeyInput& input, const KeyScratch& scratch, int bx, int by,
                const Image<std::uint8_t>& matte, Image<float>& view_w);

}  // namespace mixrig::render::cpu
