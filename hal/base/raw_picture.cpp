// SPDX-License-Identifier: Apache-2.0
#include "hal/base/raw_picture.h"

#include <algorithm>

namespace mixrig {
namespace {

int sample_at(const RawPicture& picture, int x, int y) {
  return picture
      .bytes[static_cast<std::size_t>(y) * picture.stride_bytes + static_cast<std::size_t>(x)];
}

Rgb8 mapped(const RawPicture& picture, Rgb8 c) {
  if (picture.samples == nullptr) return c;
  const SampleTable& table = *picture.samples;
  return {table[c.r].r, table[c.g].g, table[c.b].b};
}

Rgb8 rgb_of(const YuvToRgb& f, int y, int u, int v) {
  const int base = (y * f.y_scale >> f.y_shift) + f.y_add;
  const auto cut = [&](int sum) {
    return static_cast<std::uint8_t>(std::clamp(sum >> f.shift, 0, 255));
  };
  return {cut(base + f.red_v * (v - 128)),
          cut(base + f.green_u * (u - 128) + f.green_v * (v - 128)),
          cut(base + f.blue_u * (u - 128))};
}

/// Mirrors an index at the ends; a side of one pixel has only itself.
int mirrored(int at, int count) {
  if (count == 1) return 0;
  return at < 0 ? -at : at >= count ? 2 * count - 2 - at : at;
}

/// Returns the sample of a pixel, or of a mirrored one outside, as sRGB of its own colour.
int bayer_at(const RawPicture& picture, int x, int y) {
  const int sample =
      sample_at(picture, mirrored(x, picture.size.width), mirrored(y, picture.size.height));
  if (picture.samples == nullptr) return sample;
  const Rgbx8 c = (*picture.samples)[static_cast<std::size_t>(sample)];
  const bool red_row = (y & 1) == picture.red_y, red_column = (x & 1) == picture.red_x;
  return red_row != red_column ? c.g : red_row ? c.r : c.b;
}

/// Interpolates a Bayer pixel bilinearly.
Rgb8 bayer_pixel(const RawPicture& p, int x, int y) {
  const auto at = [&](int dx, int dy) { return bayer_at(p, x + dx, y + dy); };
  const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
  const bool red_row = (y & 1) == p.red_y;
  const std::uint8_t own = byte(at(0, 0));
  if (((x & 1) == p.red_x) == red_row) {  // a red or blue sample
    const auto green = byte((at(-1, 0) + at(1, 0) + at(0, -1) + at(0, 1) + 2) / 4);
    const auto other = byte((at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1) + 2) / 4);
    return red_row ? Rgb8{own, green, other} : Rgb8{other, green, own};
  }
  const auto across = byte((at(-1, 0) + at(1, 0) + 1) / 2);
  const auto along = byte((at(0, -1) + at(0, 1) + 1) / 2);
  return red_row ? Rgb8{across, own, along} : Rgb8{along, own, across};
}

}  // namespace

std::string_view name(RawLayout layout) {
  constexpr std::array<std::string_view, 4> kNames{"yuyv", "nv12", "grey", "bayer"};
  return kNames[static_cast<std::size_t>(layout)];
}

Rgb8 pixel_of(const RawPicture& picture, int x, int y) {
  switch (picture.layout) {
    case RawLayout::kYuyv: {
      const int pair = 4 * (x / 2);
      return mapped(picture,
                    rgb_of(picture.yuv, sample_at(picture, 2 * x, y),
                           sample_at(picture, pair + 1, y), sample_at(picture, pair + 3, y)));
    }
    case RawLayout::kNv12: {
      const int row = picture.size.height + y / 2, pair = 2 * (x / 2);
      return mapped(picture,
                    rgb_of(picture.yuv, sample_at(picture, x, y), sample_at(picture, pair, row),
                           sample_at(picture, pair + 1, row)));
    }
    case RawLayout::kGray: {
      const auto sample = static_cast<std::uint8_t>(sample_at(picture, x, y));
      return mapped(picture, {sample, sample, sample});
    }
    case RawLayout::kBayer:
      return bayer_pixel(picture, x, y);
  }
  return {};
}

}  // namespace mixrig
