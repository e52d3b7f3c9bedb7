// SPDX-License-Identifier: Apache-2.0
// Half precision (IEEE 754 binary16), and a linear colour of three half floats.
#pragma once

#include <bit>
#include <cstdint>

namespace mixrig {

/// Rounds to the nearest half float, ties away from zero; results below 2^-14 are subnormal. Values
/// above 65504 and NaN become 65504, negative values 0.
inline std::uint16_t half_of_float(float value) {
  constexpr std::uint32_t kMost = 0x7BFF;
  if (!(value > 0)) return value == value ? 0 : kMost;
  if (value >= 65504.0F) return kMost;
  if (value < 6.1035156e-5F)  // 2^-14
    return static_cast<std::uint16_t>(value * 16777216.0F + 0.5F);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value) + 0x1000;
  return static_cast<std::uint16_t>((bits >> 13) - ((127 - 15) << 10));
}

/// Converts without loss. `half` must be finite and not negative.
inline float float_of_half(std::uint16_t half) {
  if (half < 0x400) return static_cast<float>(half) * 5.9604645e-8F;  // 2^-24
  return std::bit_cast<float>((static_cast<std::uint32_t>(half) << 13) + ((127U - 15U) << 23));
}

/// A colour in linear light as three half floats.
struct RgbHalf {
  std::uint16_t r = 0, g = 0, b = 0;
  bool operator==(const RgbHalf&) const = default;
};

}  // namespace mixrig
