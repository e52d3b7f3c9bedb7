// SPDX-License-Identifier: Apache-2.0
// People by formula, in the depth picture of a camera: upright elliptic cylinders with a narrower
// head.
#pragma once

#include <cmath>
#include <vector>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"

namespace mixrig::plan {

struct StandingBody {
  double x_m = 0, y_m = 0, yaw_rad = 0;
  double height_m = 1.75, half_width_m = 0.22, half_depth_m = 0.13;
};

inline geometry::Pinhole people_view() { return {{320, 256}, 250, 250, 159.5, 127.5}; }
inline geometry::Pose people_camera() {
  return geometry::look_at({0, 0, 1.5}, {4, 0, 1.0}, Eigen::Vector3d::UnitZ());
}

/// z in metres of the nearest body at each pixel, 0 elsewhere.
inline Image<float> draw_people(const std::vector<StandingBody>& people,
                                const geometry::Pinhole& view = people_view(),
                                const geometry::Pose& pose = people_camera()) {
  Image<float> depth_m(view.size_px);
  const Eigen::Vector3d eye = pose.translation_m;
  for (int y = 0; y < depth_m.height(); ++y)
    for (int x = 0; x < depth_m.width(); ++x) {
      const Eigen::Vector3d ray = pose.rotation * Eigen::Vector3d((x - view.cx_px) / view.fx_px,
                                                                  (y - view.cy_px) / view.fy_px, 1);
      double nearest = 1e9;
      for (const StandingBody& b : people)
        for (const bool head : {false, true}) {
          const double from_m = head ? 0.86 * b.height_m : 0,
                       to_m = head ? b.height_m : 0.86 * b.height_m;
          const double a = head ? 0.09 : b.half_width_m, c = head ? 0.1 : b.half_depth_m;
          // In axes of the ellipse, scaled to the unit circle: |o + t d| = 1.
          const double cs = std::cos(b.yaw_rad), sn = std::sin(b.yaw_rad);
          const double ox = eye.x() - b.x_m, oy = eye.y() - b.y_m;
          const double u0 = (cs * ox + sn * oy) / c, v0 = (-sn * ox + cs * oy) / a;
          const double u1 = (cs * ray.x() + sn * ray.y()) / c;
          const double v1 = (-sn * ray.x() + cs * ray.y()) / a;
          const double p = u1 * u1 + v1 * v1, q = u0 * u1 + v0 * v1, r = u0 * u0 + v0 * v0 - 1;
          const double root = q * q - p * r;
          if (root < 0) continue;
          const double t = (-q - std::sqrt(root)) / p, z = eye.z() + t * ray.z();
          if (t > 0 && z >= from_m && z < to_m) nearest = std::min(nearest, t);
        }
      depth_m.at(x, y) = nearest < 1e9 ? static_cast<float>(nearest) : 0;
    }
  return depth_m;
}

}  // namespace mixrig::plan
