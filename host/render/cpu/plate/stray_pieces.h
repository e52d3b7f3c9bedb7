// SPDX-License-Identifier: Apache-2.0
// Pass correct: small pieces of depth that hang far in front of all that is around them.
#pragma once

#include "hal/base/image.h"
#include "host/render/contract/passes.h"

namespace mixrig::render::cpu {

/// Pixels at the picture's border that no piece is looked for in: the window does not fit there.
inline constexpr int kStrayBorderPx = kStrayReachPx + 1;

/// Copies row y of `z_m` (metres, 0 unknown) to `out_m`, the pixels of stray pieces as 0. A ToF
/// camera with several frequencies puts pixels that saw two surfaces a period too near, mostly
/// along a limb that moves; neighbours err alike, so that they support each other. A piece is what
/// is connected (eight neighbours) and nearer than kStrayGap times the pixel; it is stray when it
/// ends within kStrayReachPx and has at most stray_px_m2 / z^2 pixels. Threads: rows are
/// independent.
void drop_stray_pieces(const CorrectParams& params, const float* z_m, std::ptrdiff_t stride, int y,
                       Size size, float* out_m);

}  // namespace mixrig::render::cpu
