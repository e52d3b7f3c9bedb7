// SPDX-License-Identifier: Apache-2.0
// The studio's own lenses.
#include "studio/sensors/lens.h"

#include <algorithm>
#include <cmath>

namespace mixrig::studio {

Eigen::Vector2d distort(const Optics& optics, const Eigen::Vector2d& ideal) {
  const auto& [k1, k2, p1, p2, k3] = optics.distortion;
  const double x = ideal.x(), y = ideal.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  if (optics.prism != std::array<double, 2>{}) {
    const auto& [sx, sy] = optics.prism;
    Optics without = optics;
    without.prism = {};
    return distort(without, ideal) + r2 * r2 * Eigen::Vector2d(sx, sy);
  }
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Vector2d undistort(const Optics& optics, const Eigen::Vector2d& distorted) {
  Eigen::Vector2d ideal = distorted;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d miss = distorted - distort(optics, ideal);
    ideal += 0.9 * miss;
    if (miss.squaredNorm() < 1e-24) break;
  }
  return ideal;
}

Eigen::Vector2d project(const Optics& optics, const Eigen::Vector3d& p) {
  const Eigen::Vector2d d = distort(optics, {p.x() / p.z(), p.y() / p.z()});
  return {optics.fx_px * d.x() + optics.cx_px, optics.fy_px * d.y() + optics.cy_px};
}

RayGrid::RayGrid(const Optics& optics) : size_(optics.size_px) {
  corners_.reserve(Size{size_.width + 1, size_.height + 1}.area());
  for (int y = 0; y <= size_.height; ++y)
    for (int x = 0; x <= size_.width; ++x)
      corners_.push_back(undistort(optics, {(x - 0.5 - optics.cx_px) / optics.fx_px,
                                            (y - 0.5 - optics.cy_px) / optics.fy_px})
                             .cast<float>());
}

Eigen::Vector2f RayGrid::at(float u_px, float v_px) const {
  const float u = u_px + 0.5F, v = v_px + 0.5F;
  const int x = std::clamp(static_cast<int>(u), 0, size_.width - 1);
  const int y = std::clamp(static_cast<int>(v), 0, size_.height - 1);
  const Eigen::Vector2f* row = &corners_[static_cast<std::size_t>(y) * (size_.width + 1) + x];
  const Eigen::Vector2f* below = row + size_.width + 1;
  const float s = u - static_cast<float>(x), t = v - static_cast<float>(y);
  return (1 - t) * ((1 - s) * row[0] + s * row[1]) + t * ((1 - s) * below[0] + s * below[1]);
}

namespace {

double radius_of(const FisheyeOptics& o, double angle) {
  return o.f_px * angle * (1 + angle * angle * (o.k1 + angle * angle * o.k2));
}

}  // namespace

bool fisheye_ray(const FisheyeOptics& o, double u_px, double v_px, Eigen::Vector3d& ray) {
  const double x = u_px - o.cx_px, y = v_px - o.cy_px, r = std::hypot(x, y);
  if (r > radius_of(o, 0.5 * o.field_rad)) return false;
  double angle = r / o.f_px;
  for (int i = 0; i < 8; ++i) {
    const double a2 = angle * angle, slope = o.f_px * (1 + a2 * (3 * o.k1 + 5 * a2 * o.k2));
    angle -= (radius_of(o, angle) - r) / slope;
  }
  const double scale = r > 0 ? std::sin(angle) / r : 0;
  ray = {x * scale, y * scale, std::cos(angle)};
  return true;
}

}  // namespace mixrig::studio
