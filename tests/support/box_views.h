// SPDX-License-Identifier: Apache-2.0
// Views of a box from a head in its middle. Rays are computed by formula, without the pipeline's
// projection.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::test {

inline const Eigen::Vector3d kBoxHalf_m(2.5, 2.0, 1.5);  ///< the origin is in the box's middle
inline constexpr int kBoxColumns = 96, kBoxRows = 80;

inline geometry::CameraModel box_camera() {
  return {{{kBoxColumns, kBoxRows}, 70, 70, 47.5, 39.5}, {}};
}

/// Distance of the box's wall along a ray from inside it.
inline double to_wall_m(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  double nearest = 1e9;
  for (int k = 0; k < 3; ++k)
    if (ray[k] != 0)
      nearest = std::min(nearest, (std::copysign(kBoxHalf_m[k], ray[k]) - from[k]) / ray[k]);
  return nearest;
}

/// Pose of the camera, 8 cm from the origin and off the tilt axis. Axes of the base: right, ahead,
/// up.
inline geometry::Pose head_pose(double pan_rad, double tilt_rad) {
  const Eigen::Quaterniond head(Eigen::AngleAxisd(pan_rad, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()));
  Eigen::Matrix3d camera;  // x right, y down, z ahead
  camera << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return {head * Eigen::Quaterniond(camera), head * Eigen::Vector3d(0.05, 0.05, 0.04)};
}

/// Noise and extra surfaces of a view of the box.
struct BoxView {
  double noise_m = 0;
  double sheet_m = 0;     ///< distance of a sheet over the whole picture; 0: none
  bool textured = false;  ///< waves of 0.25 m on the walls; else one colour
};

/// A view whose target and ToF camera are both box_camera() at head_pose().
inline model::ScanView box_view(double pan_rad, double tilt_rad, const BoxView& how = {}) {
  const auto camera = box_camera();
  model::ScanView view;
  view.base_from_tof = view.base_from_target = head_pose(pan_rad, tilt_rad);
  view.distance_m.reset(camera.size_px());
  view.sigma_m.reset(camera.size_px(), static_cast<float>(std::max(how.noise_m, 0.002)));
  view.plate.reset(camera.size_px(), Rgb8{200, 100, 50});
  std::mt19937 random(static_cast<unsigned>(1000 * (pan_rad + 4) + 10 * tilt_rad));
  std::normal_distribution<double> normal;
  for (int y = 0; y < kBoxRows; ++y)
    for (int x = 0; x < kBoxColumns; ++x) {
      const Eigen::Vector3d eye_m = view.base_from_tof.translation_m;
      const Eigen::Vector3d ray =
          (view.base_from_tof.rotation * Eigen::Vector3d((x - 47.5) / 70, (y - 39.5) / 70, 1))
              .normalized();
      double d_m = to_wall_m(eye_m, ray);
      if (how.textured) {
        const Eigen::Vector3d p = 25 * (eye_m + d_m * ray);
        const double wave = std::sin(p.x()) + std::sin(p.y() + 1) + std::sin(p.z() + 2);
        view.plate.at(x, y).g = static_cast<std::uint8_t>(std::lround(120 + 35 * wave));
      }
      if (how.sheet_m > 0) d_m = std::min(d_m, how.sheet_m);
      view.distance_m.at(x, y) = static_cast<float>(d_m + how.noise_m * normal(random));
    }
  return view;
}

/// 50 views that cover all directions.
inline std::vector<model::ScanView> box_views(const BoxView& how = {}) {
  std::vector<model::ScanView> views;
  for (int tilt = -2; tilt <= 2; ++tilt)
    for (int pan = 0; pan < 10; ++pan)
      views.push_back(box_view(2 * M_PI * pan / 10, 0.7 * tilt, how));
  return views;
}

}  // namespace mixrig::test
