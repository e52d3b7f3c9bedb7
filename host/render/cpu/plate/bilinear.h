// SPDX-License-Identifier: Apache-2.0
// Bilinear sampling of linear 16-bit pixels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/render/cpu/plate/srgb.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {

/// A coordinate clamped to [0, size - 1], as pixel and fraction in 1/256.
struct Split {
  std::uint32_t pixel;
  std::uint16_t fraction;
};
inline Split split(float at, int size) {
  const float clamped = std::clamp(at, 0.0F, static_cast<float>(size - 1));
  // Rounds like std::lround for values that are not negative, without a call: adding a half is
  // exact here.
  const double half_up = static_cast<double>(256 * clamped) + 0.5;
  const auto fixed = static_cast<std::uint32_t>(static_cast<std::int32_t>(half_up));
  // The last pixel is the right one of its pair, so that pairs stay inside the image.
  const auto pixel = std::min(fixed / 256, static_cast<std::uint32_t>(std::max(0, size - 2)));
  return {pixel, static_cast<std::uint16_t>(fixed - 256 * pixel)};
}

using U16x8 = std::uint16_t __attribute__((vector_size(16)));
using U32x8 = std::uint32_t __attribute__((vector_size(32)));
using U32x4 = std::uint32_t __attribute__((vector_size(16)));

/// Place of a bilinear sample: the upper left of four pixels and the offset from it in 1/256 px,
/// the precision of GPUs' texture units.
struct Tap {
  std::uint32_t offset = 0;  ///< pixels from the first one of the image
  std::uint16_t fraction_x = 0, fraction_y = 0;
};

/// Interpolates between two pairs of neighbours, fractions in 1/256. 16-bit values and weights that
/// sum to 2^16 fit 32 bits exactly. U32x8 is not passed between functions: where registers are
/// shorter the compiler uses two.
inline U16x4 blend(const Rgbx16* top, const Rgbx16* low, std::uint32_t fx, std::uint32_t fy) {
  const U32x8 rows = __builtin_convertvector(load<U16x8>(top), U32x8) * (256 - fy) +
                     __builtin_convertvector(load<U16x8>(low), U32x8) * fy;
  const std::uint32_t gx = 256 - fx;
  const U32x8 both = rows * U32x8{gx, gx, gx, gx, fx, fx, fx, fx};
  const U32x4 sum = __builtin_shufflevector(both, both, 0, 1, 2, 3) +
                    __builtin_shufflevector(both, both, 4, 5, 6, 7);
  return __builtin_convertvector((sum + 0x7FFFU) >> 16, U16x4);
}

/// Samples that blend_run() computes at once.
#if defined(__AVX512BW__) && defined(__AVX512DQ__)
inline constexpr int kBlendPx = 4;
#elif defined(__AVX2__)
inline constexpr int kBlendPx = 2;
#else
inline constexpr int kBlendPx = 1;
#endif

/// Stores kBlendPx samples to `to`, each equal to blend(). `first`: first pixel of the image;
/// `down`: pixels from row to row. Multiply-add takes signed 16-bit numbers, so 2^15 is subtracted
/// from the values and added again with the rounding: nothing is lost.
inline void blend_run(const Tap* taps, const Rgbx16* first, std::ptrdiff_t down, Rgbx16* to) {
#if defined(__AVX512BW__) && defined(__AVX512DQ__)
  const auto four = [&](std::ptrdiff_t row) {
    const auto pair = [&](int i) {
      return _mm_loadu_si128(reinterpret_cast<const __m128i*>(first + taps[i].offset + row));
    };
    const __m256i low = _mm256_inserti128_si256(_mm256_castsi128_si256(pair(0)), pair(1), 1);
    const __m256i high = _mm256_inserti128_si256(_mm256_castsi128_si256(pair(2)), pair(3), 1);
    const __m512i all = _mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
    // Places neighbours side by side: r r g g b b x x.
    const __m512i order =
        _mm512_broadcast_i32x4(_mm_setr_epi8(0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15));
    return _mm512_shuffle_epi8(_mm512_xor_si512(all, _mm512_set1_epi16(-0x8000)), order);
  };
  const __m512i at = _mm512_permutexvar_epi64(
      _mm512_setr_epi64(0, 0, 1, 1, 2, 2, 3, 3),
      _mm512_castsi256_si512(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(taps))));
  const __m512i fx = _mm512_shuffle_epi8(at, _mm512_set1_epi16(0x0504));
  const __m512i fy = _mm512_shuffle_epi8(at, _mm512_set1_epi32(static_cast<int>(0x80800706U)));
  const __m512i wx = _mm512_mask_sub_epi16(fx, 0x55555555U, _mm512_set1_epi16(256), fx);
  const __m512i top = _mm512_madd_epi16(four(0), wx), low = _mm512_madd_epi16(four(down), wx);
  const __m512i sum = _mm512_add_epi32(_mm512_slli_epi32(top, 8),
                                       _mm512_mullo_epi32(_mm512_sub_epi32(low, top), fy));
  const __m512i rounded = _mm512_srli_epi32(
      _mm512_add_epi32(sum, _mm512_set1_epi32(static_cast<int>(0x80007FFFU))), 16);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm512_cvtepi32_epi16(rounded));
#elif defined(__AVX2__)
  const auto two = [&](std::ptrdiff_t row) {
    const auto pair = [&](int i) {
      return _mm_loadu_si128(reinterpret_cast<const __m128i*>(first + taps[i].offset + row));
    };
    const __m256i both = _mm256_inserti128_si256(_mm256_castsi128_si256(pair(0)), pair(1), 1);
    // Places neighbours side by side: r r g g b b x x.
    const __m256i order = _mm256_broadcastsi128_si256(
        _mm_setr_epi8(0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15));
    return _mm256_shuffle_epi8(_mm256_xor_si256(both, _mm256_set1_epi16(-0x8000)), order);
  };
  const __m256i at = _mm256_permute4x64_epi64(
      _mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(taps))), 0x50);
  const __m256i fx = _mm256_shuffle_epi8(at, _mm256_set1_epi16(0x0504));
  const __m256i fy = _mm256_shuffle_epi8(at, _mm256_set1_epi32(static_cast<int>(0x80800706U)));
  const __m256i wx = _mm256_blend_epi16(fx, _mm256_sub_epi16(_mm256_set1_epi16(256), fx), 0x55);
  const __m256i top = _mm256_madd_epi16(two(0), wx), low = _mm256_madd_epi16(two(down), wx);
  const __m256i sum = _mm256_add_epi32(_mm256_slli_epi32(top, 8),
                                       _mm256_mullo_epi32(_mm256_sub_epi32(low, top), fy));
  const __m256i rounded = _mm256_srli_epi32(
      _mm256_add_epi32(sum, _mm256_set1_epi32(static_cast<int>(0x80007FFFU))), 16);
  const __m256i packed = _mm256_permute4x64_epi64(_mm256_packus_epi32(rounded, rounded), 0x08);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm256_castsi256_si128(packed));
#else
  const Rgbx16* p = first + taps->offset;
  store(to, blend(p, p + down, taps->fraction_x, taps->fraction_y));
#endif
}

}  // namespace mixrig::render::cpu
