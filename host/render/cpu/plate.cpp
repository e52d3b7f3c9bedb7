// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/plate.h"

#include "host/render/cpu/bilinear.h"

namespace mixrig::render::cpu {
namespace {

constexpr std::uint32_t kGainOne = 4096;

void decode_row(const Rgb8* from, int width, Rgbx16* to) {
  const auto& linear = srgb_to_linear();
  for (int x = 0; x < width; ++x)
    to[x] = {linear[from[x].r], linear[from[x].g], linear[from[x].b], 0};
}

void sample_row(const PlateTap* taps, int width, const Image<Rgbx16>& from, Rgbx16* to) {
  const Rgbx16* first = from.row(0);
  const std::ptrdiff_t down = from.height() > 1 ? from.stride() : 0;
  for (int x = 0; x < width; ++x) {
    const Rgbx16* p = first + taps[x].offset;
    store(to + x, blend(p, p + down, taps[x].fraction_x, taps[x].fraction_y));
  }
}

/// Brighter by `gain`, as far as white.
void brighten_row(const std::uint16_t* gain, int width, Rgbx16* row) {
  for (int x = 0; x < width; ++x) {
    const U32x4 light = __builtin_convertvector(load<U16x4>(row + x), U32x4);
    const U32x4 more = (light * gain[x] + kGainOne / 2) / kGainOne;
    const U32x4 white = U32x4{} + 0xFFFFU;
    store(row + x, __builtin_convertvector(more < white ? more : white, U16x4));
  }
}

void tap_row(const glm::vec2* plate_px, int width, Size plate, std::ptrdiff_t stride,
             PlateTap* taps) {
  for (int x = 0; x < width; ++x) {
    const Split u = split(plate_px[x].x, plate.width), v = split(plate_px[x].y, plate.height);
    taps[x] = {v.pixel * static_cast<std::uint32_t>(stride) + u.pixel, u.fraction, v.fraction};
  }
}

}  // namespace

void PlateScratch::see_through(Crew& crew, const geometry::CameraModel& target,
                               const geometry::Pinhole& view) {
  constexpr int kLensGrain = 16;
  if (plate_px.empty()) plate_px.reset(taps.size());
  crew.rows(taps.height(), kLensGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      plate_row(target, view, y, plate_px.row(y));
      tap_row(plate_px.row(y), taps.width(), target.size_px(), decoded.stride(), taps.row(y));
    }
  });
}

PlateScratch::PlateScratch(const Tables& tables) {
  if (tables.plate_is_view) return;
  const Size plate = tables.plate_size;
  // One column more, so that pairs of a picture one pixel wide have two pixels.
  decoded.reset({plate.width + 1, plate.height});
  taps.reset(tables.view_size);
  for (int y = 0; y < taps.height(); ++y)
    tap_row(tables.plate_px.row(y), taps.width(), plate, decoded.stride(), taps.row(y));
  gain.reset(tables.plate_gain.size());
  for (int y = 0; y < gain.height(); ++y)
    for (int x = 0; x < gain.width(); ++x)
      gain.row(y)[x] = static_cast<std::uint16_t>(
          std::lround(static_cast<float>(kGainOne) * tables.plate_gain.row(y)[x]));
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
    for (int y = begin; y < end; ++y) {
      sample_row(scratch.taps.row(y), out.width(), scratch.decoded, out.row(y));
      if (!scratch.gain.empty()) brighten_row(scratch.gain.row(y), out.width(), out.row(y));
    }
  });
}

}  // namespace mixrig::render::cpu
