// SPDX-License-Identifier: Apache-2.0
// Short vectors of the compiler (GCC and clang). None is wider than the target's registers: g++
// expands wider comparisons element by element, and passes wider values by another ABI.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace mixrig::render::cpu {

/// Number of 32-bit values in a register of the target. AVX alone has no 32-byte integer
/// operations.
#if defined(__AVX512F__)
inline constexpr int kLanes = 16;
inline constexpr const char* kVectorName = "AVX-512";
#elif defined(__AVX2__)
inline constexpr int kLanes = 8;
inline constexpr const char* kVectorName = "AVX2";
#elif defined(__SSE2__)
inline constexpr int kLanes = 4;
inline constexpr const char* kVectorName = "SSE";
#elif defined(__ARM_NEON)
inline constexpr int kLanes = 4;
inline constexpr const char* kVectorName = "NEON";
#else
inline constexpr int kLanes = 4;
inline constexpr const char* kVectorName = "none";
#endif

using F4 = float __attribute__((vector_size(16)));
using I4 = std::int32_t __attribute__((vector_size(16)));
using U16x4 = std::uint16_t __attribute__((vector_size(8)));
/// A register of floats, and of integers. Comparisons of FloatLanes give IntLanes: -1 true, 0
/// false.
using FloatLanes = float __attribute__((vector_size(4 * kLanes)));
using IntLanes = std::int32_t __attribute__((vector_size(4 * kLanes)));

/// A 3-vector for each of kLanes points.
struct VectorLanes {
  FloatLanes x, y, z;
};

/// One byte a lane.
using ByteLanes = std::uint8_t __attribute__((vector_size(kLanes)));

template <typename V>
V load(const void* from) {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <typename V>
void store(void* to, V v) {
  std::memcpy(to, &v, sizeof v);
}

/// Minimum and maximum like std::min and std::max: the first where neither is less, or one is NaN.
inline FloatLanes min(FloatLanes a, FloatLanes b) { return b < a ? b : a; }
inline FloatLanes max(FloatLanes a, FloatLanes b) { return a < b ? b : a; }
inline FloatLanes abs(FloatLanes f) {
  return std::bit_cast<FloatLanes>(std::bit_cast<IntLanes>(f) & 0x7FFFFFFF);
}
inline FloatLanes to_float(IntLanes i) { return __builtin_convertvector(i, FloatLanes); }
inline FloatLanes sqrt(FloatLanes f) {
  for (int i = 0; i < kLanes; ++i) f[i] = std::sqrt(f[i]);
  return f;
}
/// 1 / f with a relative error of 2^-22; infinite or NaN for 0.
inline FloatLanes inverse(FloatLanes f) {
#if defined(__AVX512F__)
  const auto about = std::bit_cast<FloatLanes>(_mm512_rcp14_ps(std::bit_cast<__m512>(f)));
  return about * (2 - f * about);
#else
  return 1 / f;
#endif
}
inline float least_of(FloatLanes f) {
#if defined(__AVX512F__)
  return _mm512_reduce_min_ps(std::bit_cast<__m512>(f));
#else
  float least = f[0];
  for (int i = 1; i < kLanes; ++i) least = least < f[i] ? least : f[i];
  return least;
#endif
}
/// Minimum and maximum of vectors of four.
inline F4 min4(F4 a, F4 b) { return b < a ? b : a; }
inline F4 max4(F4 a, F4 b) { return a < b ? b : a; }
inline float least_of4(F4 f) {
  const F4 halves = min4(f, __builtin_shufflevector(f, f, 2, 3, 0, 1));
  return halves[1] < halves[0] ? halves[1] : halves[0];
}
inline float sum(FloatLanes f) {
  float total = 0;
  for (int i = 0; i < kLanes; ++i) total += f[i];
  return total;
}
/// One bit a lane, set where a comparison is true.
inline unsigned bits_of(IntLanes mask) {
#if defined(__AVX512F__)
  const auto m = std::bit_cast<__m512i>(mask);
  return _mm512_test_epi32_mask(m, m);
#elif defined(__AVX2__)
  return static_cast<unsigned>(_mm256_movemask_ps(std::bit_cast<__m256>(mask)));
#else
  unsigned bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= static_cast<unsigned>(mask[i] & 1) << i;
  return bits;
#endif
}
/// Whether any lane of a comparison is true.
inline bool any(IntLanes mask) { return bits_of(mask) != 0; }
/// Loads from[index] for each lane.
inline FloatLanes gather(const float* from, IntLanes index) {
#if defined(__AVX512F__)
  return std::bit_cast<FloatLanes>(
      _mm512_i32gather_ps(std::bit_cast<__m512i>(index), from, sizeof(float)));
#elif defined(__AVX2__)
  return std::bit_cast<FloatLanes>(
      _mm256_i32gather_ps(from, std::bit_cast<__m256i>(index), sizeof(float)));
#else
  FloatLanes out;
  for (int i = 0; i < kLanes; ++i) out[i] = from[index[i]];
  return out;
#endif
}
/// Loads the four bytes at from + offset for each lane.
inline IntLanes gather_bytes(const void* from, IntLanes offset) {
#if defined(__AVX512F__)
  return std::bit_cast<IntLanes>(_mm512_i32gather_epi32(std::bit_cast<__m512i>(offset), from, 1));
#elif defined(__AVX2__)
  return std::bit_cast<IntLanes>(
      _mm256_i32gather_epi32(static_cast<const int*>(from), std::bit_cast<__m256i>(offset), 1));
#else
  IntLanes out;
  for (int i = 0; i < kLanes; ++i)
    std::memcpy(&out[i], static_cast<const char*>(from) + offset[i], sizeof(std::int32_t));
  return out;
#endif
}
/// Rounds towards zero; the value must fit.
inline IntLanes truncate(FloatLanes f) { return __builtin_convertvector(f, IntLanes); }
inline IntLanes to_int(ByteLanes bytes) { return __builtin_convertvector(bytes, IntLanes); }
/// The lowest eight bits of each lane.
inline ByteLanes to_bytes(IntLanes i) { return __builtin_convertvector(i, ByteLanes); }

namespace detail {
template <int kStep, int kFirst, typename V, std::size_t... i>
V every(V a, V b, std::index_sequence<i...>) {
  constexpr std::size_t kEnd = 2 * kLanes;
  return __builtin_shufflevector(a, b, static_cast<int>((kFirst + kStep * i) % kEnd)...);
}
template <std::size_t... i>
FloatLanes counted(std::index_sequence<i...>) {
  return FloatLanes{static_cast<float>(i)...};
}
}  // namespace detail

/// Takes the value at kFirst and every kStep-th one after it from the values of a followed by those
/// of b. Lanes beyond the last such value are unspecified.
template <int kStep, int kFirst, typename V>
V every(V a, V b) {
  return detail::every<kStep, kFirst>(a, b, std::make_index_sequence<kLanes>{});
}
/// The lane numbers 0, 1, 2, ...
inline FloatLanes lane_numbers() { return detail::counted(std::make_index_sequence<kLanes>{}); }

/// Natural logarithm of positive normal numbers, with absolute and relative error of 2e-7 (the
/// polynomial of Cephes' logf).
inline FloatLanes log(FloatLanes f) {
  constexpr std::int32_t kRootOfHalf = 0x3F3504F3, kMantissa = 23;
  const IntLanes bits = std::bit_cast<IntLanes>(f);
  const IntLanes exponent = (bits - kRootOfHalf) >> kMantissa;
  const FloatLanes x = std::bit_cast<FloatLanes>(bits - exponent * (1 << kMantissa)) - 1;
  FloatLanes y = 7.0376836292e-2F * x - 1.1514610310e-1F;
  for (const float c : {1.1676998740e-1F, -1.2420140846e-1F, 1.4249322787e-1F, -1.6668057665e-1F,
                        2.0000714765e-1F, -2.4999993993e-1F, 3.3333331174e-1F})
    y = y * x + c;
  const FloatLanes e = to_float(exponent), square = x * x;
  return 0.693359375F * e + (x + (square * x * y - 2.12194440e-4F * e - 0.5F * square));
}

}  // namespace mixrig::render::cpu
