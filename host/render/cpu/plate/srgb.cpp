// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/plate/srgb.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "hal/base/srgb.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

/// Linear values of a pixel's three channels, each at its place in an Rgbx16.
struct DecodeTables {
  std::array<std::uint64_t, 256> r{}, g{}, b{};
};
const DecodeTables& decode_tables() {
  static const auto kTables = [] {
    DecodeTables t;
    for (std::size_t i = 0; i < 256; ++i) {
      const std::uint16_t linear = srgb_to_linear()[i];
      t.r[i] = std::bit_cast<std::uint64_t>(Rgbx16{linear, 0, 0, 0});
      t.g[i] = std::bit_cast<std::uint64_t>(Rgbx16{0, linear, 0, 0});
      t.b[i] = std::bit_cast<std::uint64_t>(Rgbx16{0, 0, linear, 0});
    }
    return t;
  }();
  return kTables;
}

#if defined(__AVX512F__) && defined(__AVX512VL__)
/// Encodes v as (table[v / 16] + v % 16) / 16: bytes lie at least 19 values apart, so at most one
/// border lies within 16 values. The table fits the first-level cache, unlike 65536 bytes.
const std::array<std::uint16_t, 4097>& encode_table() {  // one more: gathers read four bytes
  static const auto kTable = [] {
    const std::vector<std::uint8_t>& bytes = srgb_bytes_of_linear16();
    std::array<std::uint16_t, 4097> table{};
    for (std::size_t i = 0; i < 4096; ++i) {
      const std::uint8_t first = bytes[16 * i];
      std::size_t later = 0;  // number of values with the second byte
      for (std::size_t j = 0; j < 16; ++j) later += bytes[16 * i + j] != first;
      table[i] = static_cast<std::uint16_t>(16 * first + later);
    }
    return table;
  }();
  return kTable;
}

/// Encodes four pixels into the first 12 bytes.
__m128i encode_four(const Rgbx16* from, const std::uint16_t* table) {
  const __m512i v =
      _mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(from)));
  const __m512i coarse = _mm512_i32gather_epi32(_mm512_srli_epi32(v, 4), table, 2);
  const __m512i fine = _mm512_and_si512(v, _mm512_set1_epi32(15));
  const __m128i bytes = _mm512_cvtepi32_epi8(_mm512_srli_epi32(_mm512_add_epi32(coarse, fine), 4));
  return _mm_shuffle_epi8(bytes,
                          _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1));
}
#endif

}  // namespace

const std::array<std::uint16_t, 256>& srgb_to_linear() {
  static const auto kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double linear = linear_from_srgb(static_cast<double>(i) / 255);
      table[i] = static_cast<std::uint16_t>(std::lround(65535 * linear));
    }
    return table;
  }();
  return kTable;
}

const std::array<float, 256>& linear_of_byte() {
  static const auto kTable = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i)
      table[i] = static_cast<float>(srgb_to_linear()[i]) / kLinearOne;
    return table;
  }();
  return kTable;
}

void decode_row(const Rgb8* from, int width, Rgbx16* to) {
  const DecodeTables& t = decode_tables();
  for (int x = 0; x < width; ++x) store(to + x, t.r[from[x].r] | t.g[from[x].g] | t.b[from[x].b]);
}

void encode_row(const Rgbx16* from, int width, Rgb8* to) {
  int x = 0;
#if defined(__AVX512F__) && defined(__AVX512VL__)
  const std::uint16_t* table = encode_table().data();
  // Stores whole registers as long as the surplus stays inside this row.
  for (; x + 6 <= width; x += 4)
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + x), encode_four(from + x, table));
#endif
  const std::uint8_t* srgb = srgb_bytes_of_linear16().data();
  for (; x < width; ++x) to[x] = {srgb[from[x].r], srgb[from[x].g], srgb[from[x].b]};
}

}  // namespace mixrig::render::cpu
