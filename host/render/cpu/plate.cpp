// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/plate.h"

#include <algorithm>
#include <cmath>

#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

void decode_row(const Rgb8* from, int width, Rgbx16* to) {
  const auto& linear = srgb_to_linear();
  for (int x = 0; x < width; ++x)
    to[x] = {linear[from[x].r], linear[from[x].g], linear[from[x].b], 0};
}

/// Pixel and 1/256 fraction of a coordinate, clamped to [0, size - 1].
struct Split {
  std::uint32_t pixel;
  std::uint16_t fraction;
};
Split split(float at, int size) {
  const float clamped = std::clamp(at, 0.0F, static_cast<float>(size - 1));
  const auto fixed = static_cast<std::uint32_t>(std::lround(256 * clamped));
  // The last pixel is the right one of its pair, so that pairs stay inside.
  const auto pixel = std::min(fixed / 256, static_cast<std::uint32_t>(std::max(0, size - 2)));
  return {pixel, static_cast<std::uint16_t>(fixed - 256 * pixel)};
}

using U16x8 = std::uint16_t __attribute__((vector_size(16)));
using U32x8 = std::uint32_t __attribute__((vector_size(32)));
using U32x4 = std::uint32_t __attribute__((vector_size(16)));

/// Bilinear between two pairs of neighbours. 16-bit values and weights that sum to 2^16 fill 32
/// bits exactly. U32x8 stays in here: where registers are shorter the compiler takes two.
U16x4 blend(const Rgbx16* top, const Rgbx16* low, std::uint32_t fx, std::uint32_t fy) {
  const U32x8 rows = __builtin_convertvector(load<U16x8>(top), U32x8) * (256 - fy) +
                     __builtin_convertvector(load<U16x8>(low), U32x8) * fy;
  const std::uint32_t gx = 256 - fx;
  const U32x8 both = rows * U32x8{gx, gx, gx, gx, fx, fx, fx, fx};
  const U32x4 sum = __builtin_shufflevector(both, both, 0, 1, 2, 3) +
                    __builtin_shufflevector(both, both, 4, 5, 6, 7);
  return __builtin_convertvector((sum + 0x7FFFU) >> 16, U16x4);
}

void sample_row(const PlateTap* taps, int width, const Image<Rgbx16>& from, Rgbx16* to) {
  const Rgbx16* first = from.row(0);
  const std::ptrdiff_t down = from.height() > 1 ? from.stride() : 0;
  for (int x = 0; x < width; ++x) {
    const Rgbx16* p = first + taps[x].offset;
    store(to + x, blend(p, p + down, taps[x].fraction_x, taps[x].fraction_y));
  }
}

}  // namespace

PlateScratch::PlateScratch(const Tables& tables) {
  if (tables.plate_is_view) return;
  const Size plate = tables.plate_size;
  // One column more, so that pairs of a picture one pixel wide have two pixels.
  decoded.reset({plate.width + 1, plate.height});
  taps.reset(tables.view_size);
  for (int y = 0; y < taps.height(); ++y)
    for (int x = 0; x < taps.width(); ++x) {
      const glm::vec2 at = tables.plate_px.row(y)[x];
      const Split u = split(at.x, plate.width), v = split(at.y, plate.height);
      const auto stride = static_cast<std::uint32_t>(decoded.stride());
      taps.row(y)[x] = {v.pixel * stride + u.pixel, u.fraction, v.fraction};
    }
}

void draw_plate(Crew& crew, ImageView<const Rgb8> plate, PlateScratch& scratch,
                Image<Rgbx16>& out) {
  constexpr int kGrain = 32;
  const bool plate_is_view = scratch.taps.empty();
  Image<Rgbx16>& first = plate_is_view ? out : scratch.decoded;
  crew.rows(plate.size.height, kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) decode_row(plate.row(y), plate.size.width, first.row(y));
  });
  if (plate_is_view) return;
  crew.rows(out.height(), kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      sample_row(scratch.taps.row(y), out.width(), scratch.decoded, out.row(y));
  });
}

}  // namespace mixrig::render::cpu
