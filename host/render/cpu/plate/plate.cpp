// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/plate/plate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixrig::render::cpu {
namespace {

constexpr std::uint32_t kGainOne = 4096;

void sample_row(const Tap* taps, int width, const Image<Rgbx16>& from, std::ptrdiff_t down,
                Rgbx16* to) {
  const Rgbx16* first = from.row(0);
  int x = 0;
  for (; x + kBlendPx <= width; x += kBlendPx) blend_run(taps + x, first, down, to + x);
  for (; x < width; ++x) {
    const Rgbx16* p = first + taps[x].offset;
    store(to + x, blend(p, p + down, taps[x].fraction_x, taps[x].fraction_y));
  }
}

/// Multiplies a row by `gain`, clipped at white.
void brighten_row(const std::uint16_t* gain, int width, Rgbx16* row) {
  for (int x = 0; x < width; ++x) {
    const U32x4 light = __builtin_convertvector(load<U16x4>(row + x), U32x4);
    const U32x4 more = (light * gain[x] + kGainOne / 2) / kGainOne;
    const U32x4 white = U32x4{} + 0xFFFFU;
    store(row + x, __builtin_convertvector(more < white ? more : white, U16x4));
  }
}

/// Pixels of a row of a decoded band: one column more than the plate, so that a plate one pixel
/// wide still has pairs of pixels.
std::ptrdiff_t band_stride(Size plate) { return plate.width + 1; }

/// Makes the taps of a row. `first`: plate row with which the band begins.
void tap_row(const glm::vec2* plate_px, int width, Size plate, int first, Tap* taps) {
  const auto stride = static_cast<std::uint32_t>(band_stride(plate));
  for (int x = 0; x < width; ++x) {
    const Split u = split(plate_px[x].x, plate.width), v = split(plate_px[x].y, plate.height);
    taps[x] = {(v.pixel - static_cast<std::uint32_t>(first)) * stride + u.pixel, u.fraction,
               v.fraction};
  }
}

/// Plate rows between which the taps of a view row lie.
std::pair<int, int> row_range(const glm::vec2* plate_px, int width, int plate_height) {
  int least = plate_height, most = 0;
  for (int x = 0; x < width; ++x) {
    const int row = static_cast<int>(split(plate_px[x].y, plate_height).pixel);
    least = std::min(least, row), most = std::max(most, row);
  }
  return {least, most};
}

}  // namespace

PlateScratch::PlateScratch(const Tables& tables, int threads) : plate_size_(tables.plate_size) {
  if (tables.plate_is_view) return;
  decoded.resize(static_cast<std::size_t>(threads));
  taps.reset(tables.view_size);
  plate_rows.resize(static_cast<std::size_t>((taps.height() + kBandRows - 1) / kBandRows));
  for (int band = 0; band * kBandRows < taps.height(); ++band) set_band(band, tables.plate_px);
  size_bands();
  gain.reset(tables.plate_gain.size());
  for (int y = 0; y < gain.height(); ++y)
    for (int x = 0; x < gain.width(); ++x)
      gain.row(y)[x] = static_cast<std::uint16_t>(
          std::lround(static_cast<float>(kGainOne) * tables.plate_gain.row(y)[x]));
}

/// Sets plate rows and taps of a band. `at_px`: plate pixel of each view pixel.
void PlateScratch::set_band(int band, const Image<glm::vec2>& at_px) {
  const int begin = band * kBandRows, end = std::min(begin + kBandRows, taps.height());
  int least = plate_size_.height, most = 0;
  for (int y = begin; y < end; ++y) {
    const auto [from, to] = row_range(at_px.row(y), taps.width(), plate_size_.height);
    least = std::min(least, from), most = std::max(most, to);
  }
  const int count = std::min(most + 2, plate_size_.height) - least;  // a tap reads a row below
  plate_rows[static_cast<std::size_t>(band)] = {least, count};
  for (int y = begin; y < end; ++y)
    tap_row(at_px.row(y), taps.width(), plate_size_, least, taps.row(y));
}

void PlateScratch::size_bands() {
  int rows = 0;
  for (const Rows& band : plate_rows) rows = std::max(rows, band.count);
  for (Image<Rgbx16>& band : decoded) {
    const int pixels = static_cast<int>(band_stride(plate_size_)) * rows;
    if (band.width() < pixels) band.reset({pixels, 1});
  }
}

void PlateScratch::see_through(Crew& crew, const geometry::CameraModel& target,
                               const geometry::Pinhole& view) {
  if (plate_px.empty()) plate_px.reset(taps.size());
  crew.rows(taps.height(), kBandRows, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) plate_row(target, view, y, plate_px.row(y));
    set_band(begin / kBandRows, plate_px);
  });
  size_bands();
}

void draw_plate(Crew& crew, ImageView<const Rgb8> plate, PlateScratch& scratch, Image<Rgbx16>& out,
                Image<Rgb8>* color) {
  const int width = out.width();
  if (scratch.taps.empty())  // the plate is the view
    return crew.rows(out.height(), PlateScratch::kBandRows, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) {
        decode_row(plate.row(y), width, out.row(y));
        if (color) std::copy_n(plate.row(y), width, color->row(y));
      }
    });
  const std::ptrdiff_t stride = band_stride(plate.size);
  const std::ptrdiff_t down = plate.size.height > 1 ? stride : 0;
  crew.rows_by_worker(out.height(), PlateScratch::kBandRows, [&](int worker, int begin, int end) {
    Image<Rgbx16>& band = scratch.decoded[static_cast<std::size_t>(worker)];
    const auto rows = scratch.plate_rows[static_cast<std::size_t>(begin / PlateScratch::kBandRows)];
    for (int y = 0; y < rows.count; ++y)
      decode_row(plate.row(rows.first + y), plate.size.width, band.row(0) + y * stride);
    for (int y = begin; y < end; ++y) {
      sample_row(scratch.taps.row(y), width, band, down, out.row(y));
      if (!scratch.gain.empty()) brighten_row(scratch.gain.row(y), width, out.row(y));
      if (color) encode_row(out.row(y), width, color->row(y));
    }
  });
}

}  // namespace mixrig::render::cpu
