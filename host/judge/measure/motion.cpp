// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/motion.h"

#include <cstdlib>

namespace mixrig::measure {
namespace {

constexpr int kChanged = 90;
constexpr double kLeastShare = 1e-3;

template <typename Pixel>
std::optional<double> column_of_change(ImageView<const Pixel> picture, ImageView<const Rgb8> empty,
                                       ImageView<const std::uint8_t> left_out) {
  if (picture.empty() || picture.size != empty.size) return std::nullopt;
  if (!left_out.empty() && left_out.size != empty.size) return std::nullopt;
  std::int64_t count = 0, sum = 0, seen = 0;
  for (int y = 0; y < picture.size.height; y += 2) {
    const Pixel* const a = picture.row(y);
    const Rgb8* const b = empty.row(y);
    const std::uint8_t* const out = left_out.empty() ? nullptr : left_out.row(y);
    for (int x = 0; x < picture.size.width; x += 2, ++seen)
      if ((out == nullptr || out[x] == 0) &&
          std::abs(a[x].r - b[x].r) + std::abs(a[x].g - b[x].g) + std::abs(a[x].b - b[x].b) >
              kChanged)
        ++count, sum += x;
  }
  if (static_cast<double>(count) < kLeastShare * static_cast<double>(seen)) return std::nullopt;
  return static_cast<double>(sum) / static_cast<double>(count);
}

}  // namespace

std::optional<double> changed_column(ImageView<const Rgb8> picture, ImageView<const Rgb8> empty,
                                     ImageView<const std::uint8_t> left_out) {
  return column_of_change(picture, empty, left_out);
}

std::optional<double> changed_column(ImageView<const Rgbx8> picture, ImageView<const Rgb8> empty,
                                     ImageView<const std::uint8_t> left_out) {
  return column_of_change(picture, empty, left_out);
}

}  // namespace mixrig::measure
