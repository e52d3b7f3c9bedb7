// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/splat.h"

#include <cmath>

namespace mixrig::measure {
namespace {

constexpr double kNearestSplat_m = 0.05;

/// Distance of a sample's ray from its neighbours' along either axis, per metre of z.
double spacing(ImageView<const Ray> rays, int x, int y) {
  const Ray here = rays.row(y)[x];
  const Ray right = rays.row(y)[x + 1 < rays.size.width ? x + 1 : std::max(x - 1, 0)];
  const Ray below = rays.row(y + 1 < rays.size.height ? y + 1 : std::max(y - 1, 0))[x];
  const double across = std::abs(static_cast<double>(right.x) - here.x);
  const double down = std::abs(static_cast<double>(below.y) - here.y);
  return std::fmax(across, down);  // the other one where one is NaN
}

void draw_square(double u, double v, double side_px, float z_m, ImageView<float> out_m) {
  const int x0 = std::max(0, static_cast<int>(std::ceil(u - side_px / 2)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(v - side_px / 2)));
  const int x1 = std::min(out_m.size.width - 1, static_cast<int>(std::floor(u + side_px / 2)));
  const int y1 = std::min(out_m.size.height - 1, static_cast<int>(std::floor(v + side_px / 2)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      float& there_m = out_m.row(y)[x];
      if (there_m == 0.0F || z_m < there_m) there_m = z_m;
    }
}

}  // namespace

void splat(ImageView<const float> z_m, ImageView<const Ray> rays, const Motion& m,
           const IdealView& view, ImageView<float> out_m) {
  const auto& r = m.rotation;
  const auto& t = m.translation_m;
  for (int y = 0; y < z_m.size.height; ++y) {
    for (int x = 0; x < z_m.size.width; ++x) {
      const double z = z_m.row(y)[x];
      const double px = rays.row(y)[x].x * z, py = rays.row(y)[x].y * z;
      if (!std::isfinite(px + py) || z <= 0.0) continue;
      const double qx = r[0] * px + r[1] * py + r[2] * z + t[0];
      const double qy = r[3] * px + r[4] * py + r[5] * z + t[1];
      const double qz = r[6] * px + r[7] * py + r[8] * z + t[2];
      if (qz < kNearestSplat_m) continue;
      const double u = view.fx_px * qx / qz + view.cx_px, v = view.fy_px * qy / qz + view.cy_px;
      if (!(std::abs(u) < 1e5 && std::abs(v) < 1e5)) continue;
      const double side_px = std::fmin(spacing(rays, x, y) * z / qz * view.fx_px, 1e3);
      draw_square(u, v, std::fmax(side_px, 1.0), static_cast<float>(qz), out_m);
    }
  }
}

}  // namespace mixrig::measure
