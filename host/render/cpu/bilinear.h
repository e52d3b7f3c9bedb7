// SPDX-License-Identifier: Apache-2.0
// Bilinear samples of linear 16-bit pixels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/render/cpu/simd.h"
#include "host/render/cpu/srgb.h"

namespace mixrig::render::cpu {

/// Pixel and 1/256 fraction of a coordinate, clamped to [0, size - 1].
struct Split {
  std::uint32_t pixel;
  std::uint16_t fraction;
};
inline Split split(float at, int size) {
  const float clamped = std::clamp(at, 0.0F, static_cast<float>(size - 1));
  // As std::lround of what is not negative, but without a call: half a step more is exact here.
  const double half_up = static_cast<double>(256 * clamped) + 0.5;
  const auto fixed = static_cast<std::uint32_t>(static_cast<std::int32_t>(half_up));
  // The last pixel is the right one of its pair, so that pairs stay inside.
  const auto pixel = std::min(fixed / 256, static_cast<std::uint32_t>(std::max(0, size - 2)));
  return {pixel, static_cast<std::uint16_t>(fixed - 256 * pixel)};
}

using U16x8 = std::uint16_t __attribute__((vector_size(16)));
using U32x8 = std::uint32_t __attribute__((vector_size(32)));
using U32x4 = std::uint32_t __attribute__((vector_size(16)));

/// Bilinear between two pairs of neighbours, fractions of 256. 16-bit values and weights that sum
/// to 2^16 fill 32 bits exactly. U32x8 stays in here: where registers are shorter the compiler
/// takes two.
inline U16x4 blend(const Rgbx16* top, const Rgbx16* low, std::uint32_t fx, std::uint32_t fy) {
  const U32x8 rows = __builtin_convertvector(load<U16x8>(top), U32x8) * (256 - fy) +
                     __builtin_convertvector(load<U16x8>(low), U32x8) * fy;
  const std::uint32_t gx = 256 - fx;
  const U32x8 both = rows * U32x8{gx, gx, gx, gx, fx, fx, fx, fx};
  const U32x4 sum = __builtin_shufflevector(both, both, 0, 1, 2, 3) +
                    __builtin_shufflevector(both, both, 4, 5, 6, 7);
  return __builtin_convertvector((sum + 0x7FFFU) >> 16, U16x4);
}

}  // namespace mixrig::render::cpu
