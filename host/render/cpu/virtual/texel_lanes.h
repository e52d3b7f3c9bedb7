// SPDX-License-Identifier: Apache-2.0
// Textures, bilinear and repeating, at the samples of a register of pixels.
#pragma once

#include <array>

#include "hal/base/image.h"
#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/virtual/virtual.h"

namespace mixrig::render::cpu {

/// A number for each of the four samples of a register of pixels.
using SampleLanes = std::array<FloatLanes, kPixelSamples>;

/// Whether sum_of_texels() reads within the texture; of an empty one nothing is read.
inline bool fits_lanes(ImageView<const Rgb8> texture) {
  return texture.empty() || texture.size.width > 1;
}

/// Sum of the pixels' texels in linear light, 1 = white, bilinear: over the samples that are
/// `counted` (1 or 0), which lie at (u, v) / w.
ColorLanes sum_of_texels(ImageView<const Rgb8> texture, const SampleLanes& u, const SampleLanes& v,
                         const SampleLanes& w, const SampleLanes& counted);

}  // namespace mixrig::render::cpu
