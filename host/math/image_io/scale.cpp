// SPDX-License-Identifier: Apache-2.0
#include "host/math/image_io/scale.h"

#include <algorithm>
#include <cstdint>

#include <libyuv.h>
#include <libyuv/scale_rgb.h>

namespace mixrig::image_io {
namespace {

/// Returns the part of `length` that gives the aspect ratio of the wanted sides, at least a pixel.
int part(int length, int other, int wanted, int wanted_other) {
  const std::int64_t fitting = std::int64_t{other} * wanted / wanted_other;
  return static_cast<int>(std::clamp<std::int64_t>(fitting, 1, length));
}

}  // namespace

Image<Rgb8> scaled_to_fill(ImageView<const Rgb8> picture, Size size) {
  const Size whole = picture.size;
  const Size cut{part(whole.width, whole.height, size.width, size.height),
                 part(whole.height, whole.width, size.height, size.width)};
  const Rgb8* first = picture.row((whole.height - cut.height) / 2) + (whole.width - cut.width) / 2;
  Image<Rgb8> out(size);
  libyuv::RGBScale(reinterpret_cast<const std::uint8_t*>(first),
                   static_cast<int>(picture.stride * 3), cut.width, cut.height,
                   reinterpret_cast<std::uint8_t*>(out.row(0)), static_cast<int>(out.stride() * 3),
                   size.width, size.height, libyuv::kFilterBox);
  return out;
}

}  // namespace mixrig::image_io
