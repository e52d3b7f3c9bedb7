// SPDX-License-Identifier: Apache-2.0
// A box as the cameras of a pan-tilt head see it. Rays and walls are computed by formula, without
// the pipeline. Axes of the unit's base: x right, y ahead, z up; the base is inside the box.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mixrig::test {

struct BoxRoom {
  static constexpr std::array<double, 3> kLow_m{-1.7, -1.1, -1.0}, kHigh_m{1.45, 2.6, 1.15};
  /// Cb and Cr of each wall: left, back, floor, right, front, ceiling.
  static constexpr std::array<std::array<std::uint8_t, 2>, 6> kChroma{
      {{118, 140}, {128, 128}, {136, 118}, {140, 120}, {122, 124}, {132, 134}}};

  /// First wall that a ray from inside the box hits.
  struct Hit {
    std::size_t wall = 0;  ///< axis, + 3 for the wall at its higher end
    double length = 0;     ///< distance in lengths of the ray
  };
  static Hit hit(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& ray) {
    Hit nearest{0, 1e9};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double along = ray[static_cast<Eigen::Index>(axis)];
      const bool higher = along > 0;
      const double wall_m = higher ? kHigh_m[axis] : kLow_m[axis];
      const double length = (wall_m - eye_m[static_cast<Eigen::Index>(axis)]) / along;
      if (length > 0 && length < nearest.length) nearest = {axis + (higher ? 3 : 0), length};
    }
    return nearest;
  }

  /// Luma of limited range at a point of a wall: waves of 0.55 m about a level of the wall.
  static double luma(std::size_t wall, const Eigen::Vector3d& at_m) {
    constexpr std::array<double, 6> kLevel{105, 120, 85, 145, 125, 165};
    constexpr double kWave_per_m = 2 * std::numbers::pi / 0.55;
    const auto across = static_cast<Eigen::Index>((wall + 1) % 3);
    const auto along = static_cast<Eigen::Index>((wall + 2) % 3);
    return kLevel[wall] +
           20 * std::sin(kWave_per_m * at_m[across]) * std::sin(kWave_per_m * at_m[along] + 1);
  }
};

/// A pinhole without distortion in the room. Its rays are computed once.
class BoxCamera {
 public:
  BoxCamera(int width, int height, double focal_px, double centre_x_px, double centre_y_px) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        rays_.push_back(
            Eigen::Vector3d((x - centre_x_px) / focal_px, (y - centre_y_px) / focal_px, 1)
                .normalized());
  }
  /// Distance along the ray, in whole millimetres, row by row.
  std::vector<std::uint16_t> distances_mm(const Eigen::Isometry3d& base_from_camera) const {
    std::vector<std::uint16_t> out(rays_.size());
    const Eigen::Matrix3d turn = base_from_camera.linear();
    const Eigen::Vector3d eye_m = base_from_camera.translation();
    for (std::size_t i = 0; i < rays_.size(); ++i)
      out[i] = static_cast<std::uint16_t>(1000 * BoxRoom::hit(eye_m, turn * rays_[i]).length + 0.5);
    return out;
  }
  /// A picture as YUYV, row by row. The width must be even.
  std::vector<std::uint8_t> yuyv(const Eigen::Isometry3d& base_from_camera) const {
    std::vector<std::uint8_t> out(2 * rays_.size());
    const Eigen::Matrix3d turn = base_from_camera.linear();
    const Eigen::Vector3d eye_m = base_from_camera.translation();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const Eigen::Vector3d ray = turn * rays_[i];
      const BoxRoom::Hit hit = BoxRoom::hit(eye_m, ray);
      out[2 * i] =
          static_cast<std::uint8_t>(std::lround(BoxRoom::luma(hit.wall, eye_m + hit.length * ray)));
      out[2 * i + 1] = BoxRoom::kChroma[hit.wall][i % 2];
    }
    return out;
  }

 private:
  std::vector<Eigen::Vector3d> rays_;  ///< unit; x right, y down, z ahead
};

/// Differences of a panorama from the box room.
struct BoxErrors {
  double known_pct = 0;                         ///< share of the field's directions
  std::vector<double> surface_mm;               ///< distance from the true wall, sorted
  std::array<std::vector<double>, 6> walls_mm;  ///< distance outwards from each true wall, by point

  double surface(double share) const {
    const auto last = static_cast<double>(surface_mm.size() - 1);
    return surface_mm.at(static_cast<std::size_t>(share * last));
  }
};

/// Unit ray of a pixel of an equirectangular picture, by docs/reference/room_file.md.
inline Eigen::Vector3d panorama_ray(int x, int y, int width, int height) {
  const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / width);
  const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / height);
  return {-std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
          std::sin(elevation)};
}

/// Compares a panorama with the room. `distance_m(x, y)`: 0 where it is not known. The field is
/// straight ahead. Pixels within a degree of an edge of the room do not count for the walls.
template <typename Distance>
BoxErrors box_errors(int width, int height, double field_pan_deg, double field_tilt_deg,
                     Distance distance_m) {
  BoxErrors errors;
  const auto wall_at = [&](int x, int y) {
    return BoxRoom::hit(Eigen::Vector3d::Zero(), panorama_ray(x, y, width, height)).wall;
  };
  const int half_x = static_cast<int>(field_pan_deg / 720 * width);
  const int half_y = static_cast<int>(field_tilt_deg / 360 * height), near = height / 180;
  for (int y = height / 2 - half_y; y < height / 2 + half_y; ++y)
    for (int x = width / 2 - half_x; x < width / 2 + half_x; ++x) {
      const double known_m = distance_m(x, y);
      if (known_m <= 0) continue;
      const Eigen::Vector3d ray = panorama_ray(x, y, width, height);
      const auto [wall, length_m] = BoxRoom::hit(Eigen::Vector3d::Zero(), ray);
      const double across = std::abs(ray[static_cast<Eigen::Index>(wall % 3)]);
      const double outwards_mm = 1000 * (known_m - length_m) * across;
      errors.surface_mm.push_back(std::abs(outwards_mm));
      if (wall_at(x - near, y) == wall && wall_at(x + near, y) == wall &&
          wall_at(x, y - near) == wall && wall_at(x, y + near) == wall)
        errors.walls_mm[wall].push_back(outwards_mm);
    }
  errors.known_pct =
      100.0 * static_cast<double>(errors.surface_mm.size()) / (4.0 * half_x * half_y);
  std::sort(errors.surface_mm.begin(), errors.surface_mm.end());
  return errors;
}

/// Lengths of the room by pairs of walls: width, height, and depth from the base to the front wall.
inline constexpr std::array<std::array<std::size_t, 2>, 3> kBoxLengths{{{0, 3}, {2, 5}, {4, 4}}};

/// Errors of 100 lengths between random points of two opposite walls; if `other` is `wall` itself,
/// of the lengths from the base to that wall.
struct LengthErrors {
  double mean_mm = 0, largest_mm = 0;  ///< of the absolute errors
};
inline LengthErrors length_errors(const BoxErrors& errors, std::size_t wall, std::size_t other) {
  constexpr int kLengths = 100;
  std::mt19937 random(1);
  const auto any_of = [&](const std::vector<double>& places) {
    return places.at(std::uniform_int_distribution<std::size_t>(0, places.size() - 1)(random));
  };
  LengthErrors found;
  for (int i = 0; i < kLengths; ++i) {
    double error_mm = any_of(errors.walls_mm[wall]);
    if (other != wall) error_mm += any_of(errors.walls_mm[other]);
    found.mean_mm += std::abs(error_mm) / kLengths;
    found.largest_mm = std::max(found.largest_mm, std::abs(error_mm));
  }
  return found;
}

}  // namespace mixrig::test
