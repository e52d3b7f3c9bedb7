// SPDX-License-Identifier: Apache-2.0
// Filters and noise that give virtual things the look of the plate. Shared by both back ends.
#pragma once

#include <array>
#include <cstdint>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/frame/picture_look.h"

namespace mixrig::render {

/// Weights of a pixel, and of each pixel 1 and 2 beside it; the sum over both sides is 1.
using LookTaps = std::array<float, kBlurReach + 1>;

/// Taps that make virtual things as sharp as the plate: for brightness and coverage along both
/// axes, and for colour differences along x and along y.
struct LookFilter {
  LookTaps light, chroma_x, chroma_y;
};
LookFilter look_filter(const PictureLook& look);

/// Linear colour as (brightness, red - brightness, blue - brightness, alpha).
inline glm::vec4 to_differences(const glm::vec4& c) {
  const float y = luminance(glm::vec3(c));
  return {y, c.r - y, c.b - y, c.a};
}
/// Inverse of to_differences(). Negative colours become 0; alpha above `most_alpha` is reduced to
/// it, and the colour with it.
glm::vec4 from_differences(const glm::vec4& d, float most_alpha);

/// Table of noise of sigma 1, correlated as `grain` says: noise = byte * kGrainSigmas / 127. It is
/// periodic and deterministic.
Image<PackedNormal> make_grain(const Grain& grain);
/// Texel of make_grain()'s table at which the grain of a frame begins.
glm::ivec2 grain_offset(std::uint32_t frame);

/// Taps of a Gaussian.
LookTaps blur_taps(float sigma_px);

}  // namespace mixrig::render
