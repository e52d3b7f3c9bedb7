// SPDX-License-Identifier: Apache-2.0
// Colours of neighbouring pixels in registers, one register a channel.
#pragma once

#include <algorithm>
#include <array>

#include "hal/base/srgb.h"
#include "host/render/contract/passes.h"
#include "host/render/contract/tone_curve.h"
#include "host/render/cpu/plate/srgb.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {

/// Linear light, 0..1.
struct ColorLanes {
  FloatLanes r, g, b;
};

using render::luminance;
inline FloatLanes luminance(const ColorLanes& c) {
  return kRec709Red * c.r + kRec709Green * c.g + kRec709Blue * c.b;
}
inline FloatLanes dot(const ColorLanes& a, const ColorLanes& b) {
  return a.r * b.r + a.g * b.g + a.b * b.b;
}

/// Whichever of two colours is nearer to p; a where both are as far.
inline ColorLanes nearer_to(const ColorLanes& p, const ColorLanes& a, const ColorLanes& b) {
  const ColorLanes off_a{p.r - a.r, p.g - a.g, p.b - a.b};
  const ColorLanes off_b{p.r - b.r, p.g - b.g, p.b - b.b};
  const IntLanes is_b = dot(off_b, off_b) < dot(off_a, off_a);
  return {is_b ? b.r : a.r, is_b ? b.g : a.g, is_b ? b.b : a.b};
}

/// Learned light mapped by the current tone curve, at most 1.
inline ColorLanes shown_now(const ToneCurve& tone, const ColorLanes& learned) {
  constexpr FloatLanes kOne = FloatLanes{} + 1;
  if (!tone.bends)
    return {min(tone.gain.r * learned.r, kOne), min(tone.gain.g * learned.g, kOne),
            min(tone.gain.b * learned.b, kOne)};
  const auto least = [](FloatLanes a, FloatLanes b) { return min(a, b); };
  const auto most = [](FloatLanes a, FloatLanes b) { return max(a, b); };
  return {min(tone.at(learned.r, 0, least, most), kOne),
          min(tone.at(learned.g, 1, least, most), kOne),
          min(tone.at(learned.b, 2, least, most), kOne)};
}

/// Calls read(pixels) with the kLanes pixels from x on; places beyond the row repeat its end
/// pixels.
template <typename T, typename Read>
auto read_lanes(const T* row, int x, int width, Read&& read) {
  if (x >= 0 && x + kLanes <= width) return read(row + x);
  std::array<T, kLanes> pixels;
  for (int i = 0; i < kLanes; ++i)
    pixels[static_cast<std::size_t>(i)] = row[std::clamp(x + i, 0, width - 1)];
  return read(pixels.data());
}

inline ColorLanes color_lanes(const Rgbx16* from) {
  const auto a = load<IntLanes>(from), b = load<IntLanes>(from + kLanes / 2);
  const IntLanes rg = every<2, 0>(a, b), bx = every<2, 1>(a, b);
  constexpr float kScale = 1 / kLinearOne;
  return {to_float(rg & 0xFFFF) * kScale, to_float((rg >> 16) & 0xFFFF) * kScale,
          to_float(bx & 0xFFFF) * kScale};
}

namespace detail {
/// Every third element of a, b and c in sequence, from kFirst on.
template <int kFirst, std::size_t... i>
FloatLanes third(FloatLanes a, FloatLanes b, FloatLanes c, std::index_sequence<i...>) {
  constexpr auto at = [](std::size_t k) { return kFirst + 3 * static_cast<int>(k); };
  const FloatLanes ab = __builtin_shufflevector(a, b, (at(i) % (2 * kLanes))...);
  return __builtin_shufflevector(ab, c,
                                 (at(i) < 2 * kLanes ? static_cast<int>(i) : at(i) - kLanes)...);
}
}  // namespace detail

inline ColorLanes color_lanes(const Rgbf* from) {
  const auto* p = reinterpret_cast<const float*>(from);
  const auto a = load<FloatLanes>(p), b = load<FloatLanes>(p + kLanes);
  const auto c = load<FloatLanes>(p + 2 * kLanes);
  constexpr auto kAll = std::make_index_sequence<kLanes>{};
  return {detail::third<0>(a, b, c, kAll), detail::third<1>(a, b, c, kAll),
          detail::third<2>(a, b, c, kAll)};
}

/// Colours of the kLanes pixels from x on, by read_lanes().
template <typename T>
ColorLanes color_lanes(const T* row, int x, int width) {
  return read_lanes(row, x, width, [](const T* from) { return color_lanes(from); });
}
inline FloatLanes float_lanes(const float* row, int x, int width) {
  return read_lanes(row, x, width, [](const float* from) { return load<FloatLanes>(from); });
}
inline IntLanes byte_lanes(const std::uint8_t* row, int x, int width) {
  return read_lanes(row, x, width,
                    [](const std::uint8_t* from) { return to_int(load<ByteLanes>(from)); });
}

}  // namespace mixrig::render::cpu
