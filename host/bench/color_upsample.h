// SPDX-License-Identifier: Apache-2.0
// Depth on a finer grid, the side of each depth step chosen by colour: a rung that the compositor
// does not have, to compare with.
#pragma once

#include "hal/base/image.h"

namespace mixrig::bench {

/// `low`: inverse depth or disparity, sample (i, j) at pixel (factor i + factor / 2, the same of j)
/// of `color`; 0 unknown. Between samples that are alike (`most_step` of the larger) it is
/// bilinear. Elsewhere the 4x4 samples around a pixel are two surfaces, parted at the middle of the
/// nearest four; the one whose samples are more like the pixel's colour and nearer to it has it,
/// with their weighted mean. Fills `out`, of the size of `color`.
void upsample_by_color(const Image<float>& low, ImageView<const Rgb8> color, int factor,
                       float most_step, Image<float>& out);

}  // namespace mixrig::bench
