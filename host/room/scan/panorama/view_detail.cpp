// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/view_detail.h"

#include <algorithm>
#include <cmath>

namespace mixrig::model {
namespace {

constexpr int kDetailReach_px = 2;

Image<float> shrunk(ImageView<const Rgb8> plate, int factor) {
  Image<float> out({plate.size.width / factor, plate.size.height / factor});
  const float scale = 1.0F / (3.0F * static_cast<float>(factor * factor));
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      int sum = 0;
      for (int j = 0; j < factor; ++j) {
        const Rgb8* from = plate.row(y * factor + j) + x * factor;
        for (int i = 0; i < factor; ++i) sum += from[i].r + from[i].g + from[i].b;
      }
      out.row(y)[x] = scale * static_cast<float>(sum);
    }
  return out;
}

/// Mean within the reach along a row or, transposed, along a column; borders repeat.
template <typename At>
float mean_along(int at, int count, const At& value) {
  float sum = 0;
  for (int d = -kDetailReach_px; d <= kDetailReach_px; ++d)
    sum += value(std::clamp(at + d, 0, count - 1));
  return sum / (2 * kDetailReach_px + 1);
}

}  // namespace

Image<float> detail_of(ImageView<const Rgb8> plate, int factor) {
  Image<float> out = shrunk(plate, factor);
  Image<float> rows(out.size());
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      rows.row(y)[x] = mean_along(x, out.width(), [&](int i) { return out.row(y)[i]; });
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      out.row(y)[x] -= mean_along(y, out.height(), [&](int j) { return rows.row(j)[x]; });
  return out;
}

std::optional<Detail> detail_at(const Image<float>& detail, const Eigen::Vector2d& plate_px,
                                int factor) {
  const double u = (plate_px.x() + 0.5) / factor - 0.5, v = (plate_px.y() + 0.5) / factor - 0.5;
  if (!(u >= kDetailReach_px && v >= kDetailReach_px && u < detail.width() - 1 - kDetailReach_px &&
        v < detail.height() - 1 - kDetailReach_px))
    return {};
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const double fx = u - x, fy = v - y;
  const float *top = detail.row(y) + x, *bottom = detail.row(y + 1) + x;
  const double upper = top[0] + fx * (top[1] - top[0]);
  const double lower = bottom[0] + fx * (bottom[1] - bottom[0]);
  const double left = top[0] + fy * (bottom[0] - top[0]);
  const double right = top[1] + fy * (bottom[1] - top[1]);
  return Detail{upper + fy * (lower - upper), {right - left, lower - upper}};
}

}  // namespace mixrig::model
