// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/band.h"

#include <cmath>

namespace mixrig::measure {
namespace {

/// Marks both pixels of every pair of 4-neighbours that `differ`.
template <typename T, typename Differ>
Image<std::uint8_t> borders(ImageView<const T> picture, const Differ& differ) {
  const auto [width, height] = picture.size;
  Image<std::uint8_t> marks(picture.size);
  const auto compare = [&](int xa, int ya, int xb, int yb) {
    if (differ(picture.row(ya)[xa], picture.row(yb)[xb])) marks.row(ya)[xa] = marks.row(yb)[xb] = 1;
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) compare(x, y, x + 1, y);
      if (y + 1 < height) compare(x, y, x, y + 1);
    }
  }
  return marks;
}

/// Rows to the nearest mark of the same column, at most `most_px`.
Image<int> vertical_distance_px(ImageView<const std::uint8_t> marks, int most_px) {
  const auto [width, height] = marks.size;
  Image<int> out_px(marks.size, most_px);
  for (int x = 0; x < width; ++x) {
    int distance = most_px;
    for (int y = 0; y < height; ++y) {
      distance = marks.row(y)[x] != 0 ? 0 : std::min(distance + 1, most_px);
      out_px.row(y)[x] = distance;
    }
    distance = most_px;
    for (int y = height - 1; y >= 0; --y) {
      distance = marks.row(y)[x] != 0 ? 0 : std::min(distance + 1, most_px);
      out_px.row(y)[x] = std::min(out_px.row(y)[x], distance);
    }
  }
  return out_px;
}

}  // namespace

Image<std::uint8_t> widened(ImageView<const std::uint8_t> marks, int radius_px) {
  const auto [width, height] = marks.size;
  // Vertical distance to the nearest mark of the column first, then the disc column by column.
  const Image<int> vertical_px = vertical_distance_px(marks, radius_px + 1);
  Image<std::uint8_t> out(marks.size);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint8_t inside = 0;
      for (int u = std::max(0, x - radius_px); u <= std::min(width - 1, x + radius_px); ++u) {
        const int dy = vertical_px.row(y)[u];
        inside |= (u - x) * (u - x) + dy * dy <= radius_px * radius_px;
      }
      out.row(y)[x] = inside;
    }
  }
  return out;
}

Image<std::uint8_t> step_band(ImageView<const float> depth_m, float step_m, int radius_px) {
  const auto step = [step_m](float a, float b) {
    return is_known(a) && is_known(b) && std::abs(a - b) > step_m;
  };
  return widened(borders(depth_m, step), radius_px);
}

Image<std::uint8_t> matte_band(ImageView<const std::uint8_t> matte, int radius_px) {
  const auto border = [](int a, int b) { return (a >= kHalfMatte) != (b >= kHalfMatte); };
  return widened(borders(matte, border), radius_px);
}

}  // namespace mixrig::measure
