// SPDX-License-Identifier: Apache-2.0
// Conversion between sRGB (IEC 61966-2-1) and linear light by tables. Linear light has 16 bits:
// 65535 = 1.
#pragma once

#include <array>
#include <cstdint>

#include "hal/base/image.h"

namespace mixrig::render::cpu {

/// Linear light of a pixel, 65535 = 1.0; x pads it to eight bytes.
struct Rgbx16 {
  std::uint16_t r = 0, g = 0, b = 0, x = 0;
};

inline constexpr float kLinearOne = 65535.0F;

/// Linear value of each sRGB byte, 65535 = 1.0. encode(decode(c)) = c.
const std::array<std::uint16_t, 256>& srgb_to_linear();

/// Linear value of each sRGB byte as a float, 1.0 = white.
const std::array<float, 256>& linear_of_byte();

/// Converts `width` pixels to linear light; x becomes 0.
void decode_row(const Rgb8* from, int width, Rgbx16* to);
/// Converts `width` pixels to sRGB, each channel correctly rounded.
void encode_row(const Rgbx16* from, int width, Rgb8* to);

}  // namespace mixrig::render::cpu
