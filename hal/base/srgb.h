// SPDX-License-Identifier: Apache-2.0
// sRGB (IEC 61966-2-1) to linear light and back, and luminance. The virtual studio has its own.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace mixrig {

/// Luminance of linear sRGB primaries (Rec. 709); shaders get these lines, too.
inline constexpr float kRec709Red = 0.2126F;
inline constexpr float kRec709Green = 0.7152F;
inline constexpr float kRec709Blue = 0.0722F;

/// Linear light of an sRGB value, both 0..1. T is float or double.
template <typename T>
T linear_from_srgb(T value) {
  return value <= T(0.04045) ? value / T(12.92) : std::pow((value + T(0.055)) / T(1.055), T(2.4));
}

/// sRGB value of linear light, both 0..1.
template <typename T>
T srgb_from_linear(T linear) {
  return linear <= T(0.0031308) ? T(12.92) * linear
                                : T(1.055) * std::pow(linear, T(1) / T(2.4)) - T(0.055);
}

/// Linear light 0..1 of each sRGB byte.
inline const std::array<float, 256>& linear_of_srgb_bytes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
    return values;
  }();
  return table;
}

/// sRGB byte of each linear value of 16 bit (65535 = 1), correctly rounded.
inline const std::vector<std::uint8_t>& srgb_bytes_of_linear16() {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> values(65536);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double code = srgb_from_linear(static_cast<double>(i) / 65535);
      values[i] = static_cast<std::uint8_t>(std::lround(255 * code));
    }
    return values;
  }();
  return table;
}

/// sRGB byte of linear light, rounded; clamps to 0..1.
inline std::uint8_t srgb_byte_from_linear(float linear) {
  const double clamped = std::clamp(static_cast<double>(linear), 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(255.0 * srgb_from_linear(clamped)));
}

}  // namespace mixrig
