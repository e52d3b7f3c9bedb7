// SPDX-License-Identifier: Apache-2.0
// Bilinear, repeating texture lookups at the samples of a register of pixels.
#pragma once

#include <array>

#include "hal/base/image.h"
#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/virtual/virtual.h"

namespace mixrig::render::cpu {

/// A value for each of the four samples of a register of pixels.
using SampleLanes = std::array<FloatLanes, kPixelSamples>;

/// Whether sum_of_texels() stays inside the texture; it reads nothing from an empty one.
inline bool fits_lanes(ImageView<const Rgb8> texture) {
  return texture.empty() || texture.size.width > 1;
}

/// For each pixel, the sum of bilinear texels in linear light, 1 = white, over the samples that are
/// `counted` (1 or 0); a sample lies at (u, v) / w.
ColorLanes sum_of_texels(ImageView<const Rgb8> texture, const SampleLanes& u, const SampleLanes& v,
                         const SampleLanes& w, const SampleLanes& counted);

}  // namespace mixrig::render::cpu
