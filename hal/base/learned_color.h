// SPDX-License-Identifier: Apache-2.0
// A colour of the empty room and how much it spreads, in four bytes.
#pragma once

#include <algorithm>
#include <cmath>

#include "hal/base/image.h"
#include "hal/base/srgb.h"

namespace mixrig {

inline constexpr std::uint8_t kUnknownColorByte = 255;  ///< fourth byte of an unknown colour
/// Spread that byte 254 stands for; larger ones are clamped.
inline constexpr float kMostColorSpread = 0.5F;

/// Packs a linear colour as sRGB bytes, and the spread of a linear channel as fourth byte. A colour
/// with a negative red is unknown.
inline Rgbx8 learned_color(const Rgbf& linear, float spread) {
  if (linear.r < 0) return {0, 0, 0, kUnknownColorByte};
  const float steps = (kUnknownColorByte - 1) * std::min(spread / kMostColorSpread, 1.0F);
  return {srgb_byte_from_linear(linear.r), srgb_byte_from_linear(linear.g),
          srgb_byte_from_linear(linear.b), static_cast<std::uint8_t>(std::lround(steps))};
}

/// Packs each pixel with learned_color(). An empty `spread` counts as 0.
inline Image<Rgbx8> learned_colors(ImageView<const Rgbf> linear, ImageView<const float> spread) {
  Image<Rgbx8> out(linear.size);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      out.row(y)[x] = learned_color(linear.row(y)[x], spread.empty() ? 0.0F : spread.row(y)[x]);
  return out;
}

}  // namespace mixrig
