// SPDX-License-Identifier: Apache-2.0
// A box with patterned walls, as a panorama and as fisheye pictures. Rays, walls and an equidistant
// lens are computed by formula, without the pipeline.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hal/base/image.h"
#include "host/math/geometry/fisheye_model.h"
#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::test {

class TexturedBox {
 public:
  /// `pattern` selects the look of the walls. `contrast` 0: bare walls. `period_m`: distance after
  /// which the pattern repeats; 0: it does not.
  explicit TexturedBox(unsigned pattern = 1, double contrast = 1, double period_m = 0)
      : pattern_(pattern), contrast_(contrast), period_m_(period_m) {}

  /// Objects that make localization hard. The panorama shows the mirror at the depth of its glass,
  /// and the door closed.
  struct Things {
    bool mirror = false;  ///< on the wall y = 2.9, 1.2 x 1.4 m
    double door_rad = 0;  ///< how far a door of the wall x = 2.3, 0.9 x 2 m, is open
  };
  void set(const Things& things) { things_ = things; }

  static constexpr std::array<double, 3> kLow_m{-2.1, -1.6, -1.4}, kHigh_m{2.3, 2.9, 1.5};

  /// Distance to the walls along a unit ray from inside the box.
  static double distance_m(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) {
    double nearest = 1e9;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (ray[k] > 1e-12) nearest = std::min(nearest, (kHigh_m[i] - eye[k]) / ray[k]);
      if (ray[k] < -1e-12) nearest = std::min(nearest, (kLow_m[i] - eye[k]) / ray[k]);
    }
    return nearest;
  }

  /// Grey value, 0 to 1, of what a ray hits.
  double grey(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) const {
    const Eigen::Vector3d p = eye + distance_m(eye, ray) * ray;
    if (things_.mirror && p.y() > kHigh_m[1] - 1e-6 && std::abs(p.x()) < 0.6 &&
        std::abs(p.z()) < 0.7) {
      const Eigen::Vector3d back(ray.x(), -ray.y(), ray.z());
      return 0.9 * paint(p + distance_m(p - 1e-6 * ray, back) * back);
    }
    return things_.door_rad > 0 ? behind_the_door(eye, ray, p) : paint(p);
  }

  /// Grey value, 0 to 1, of a point on a wall.
  double paint(Eigen::Vector3d p) const {
    if (period_m_ > 0)
      for (int k = 0; k < 3; ++k) p[k] -= period_m_ * std::floor(p[k] / period_m_);
    return 0.5 +
           contrast_ * (0.55 * (noise(p / 0.5, 11) - 0.5) + 0.4 * (noise(p / 0.13, 23) - 0.5));
  }

  /// `wrong_rad`: each of the panorama's 24 parts is turned by this angle, about an axis that
  /// depends on part and `seed`.
  model::Panorama panorama(int height = 360, double wrong_rad = 0, unsigned seed = 1) const {
    model::Panorama room;
    const Size size{2 * height, height};
    room.distance_m.reset(size), room.color.reset(size);
    room.sigma_m.reset(size, 0.001F), room.views.reset(size, 2), room.field.reset(size, 1);
    const Eigen::Vector3d eye = Eigen::Vector3d::Zero();
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / size.width);
        const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / height);
        Eigen::Vector3d ray(-std::cos(elevation) * std::sin(azimuth),
                            std::cos(elevation) * std::cos(azimuth), std::sin(elevation));
        if (wrong_rad > 0)
          turn_part(4 * (x * 8 / size.width) + y * 3 / height, wrong_rad, seed, ray);
        room.distance_m.at(x, y) = static_cast<float>(distance_m(eye, ray));
        room.color.at(x, y) = byte(grey(eye, ray), 0);
      }
    return room;
  }

  static constexpr double kF_px = 85;
  static constexpr Size kPicture{320, 256};
  /// The lens of picture(): radius = kF_px * angle from the axis.
  static geometry::FisheyeModel camera() {
    return geometry::FisheyeModel({kPicture, kF_px, kF_px, 160.3, 127.1, {}});
  }

  /// Picture of the fisheye, with noise of `sigma` grey values of 255 drawn from `seed`; black more
  /// than 92 degrees off the axis.
  Image<Rgb8> picture(const geometry::Pose& room_from_camera, double sigma = 0,
                      unsigned seed = 1) const {
    Image<Rgb8> out(kPicture);
    std::uint64_t state = seed * 0x9E3779B97F4A7C15ULL + 1;
    for (int y = 0; y < kPicture.height; ++y)
      for (int x = 0; x < kPicture.width; ++x) {
        const double u = x - 160.3, v = y - 127.1, radius = std::hypot(u, v);
        const double angle = radius / kF_px;
        if (angle > 92 * std::numbers::pi / 180) continue;
        const double across = radius > 0 ? std::sin(angle) / radius : 0;
        const Eigen::Vector3d ray =
            room_from_camera.rotation * Eigen::Vector3d(across * u, across * v, std::cos(angle));
        double noise = 0;  // sum of 12 uniform values: nearly normal
        for (int k = 0; k < (sigma > 0 ? 12 : 0); ++k) {
          state = state * 6364136223846793005ULL + 1442695040888963407ULL;
          noise += static_cast<double>(state >> 40) / (1 << 24) - 0.5;
        }
        out.at(x, y) = byte(grey(room_from_camera.translation_m, ray), sigma * noise);
      }
    return out;
  }

 private:
  /// Turns `ray` by `angle_rad` about an axis that depends on part and seed.
  static void turn_part(int part, double angle_rad, unsigned seed, Eigen::Vector3d& ray) {
    const double a = 2.4 * part + seed, b = std::sin(1.7 * part + 3.1 * seed);
    const Eigen::Vector3d axis = Eigen::Vector3d(std::cos(a), std::sin(a), b).normalized();
    ray = Eigen::AngleAxisd(angle_rad, axis) * ray;
  }

  static constexpr double kHinge_m = -0.5, kLeaf_m = 0.9, kDoorTop_m = 0.6;

  double behind_the_door(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray,
                         const Eigen::Vector3d& on_wall) const {
    // The leaf turns about (2.3, -0.5, z) into the box.
    const Eigen::Vector3d along(-std::sin(things_.door_rad), std::cos(things_.door_rad), 0);
    const Eigen::Vector3d normal(along.y(), -along.x(), 0), hinge(kHigh_m[0], kHinge_m, 0);
    const double t = normal.dot(hinge - eye) / normal.dot(ray);
    const Eigen::Vector3d at = eye + t * ray - hinge;
    const double out_m = at.dot(along);
    if (t > 0 && out_m > 0 && out_m < kLeaf_m && at.z() < kDoorTop_m &&
        t < distance_m(eye, ray) - 1e-9)
      return paint({kHigh_m[0], kHinge_m + out_m, at.z()});
    const bool in_the_doorway = on_wall.x() > kHigh_m[0] - 1e-6 && on_wall.y() > kHinge_m &&
                                on_wall.y() < kHinge_m + kLeaf_m && on_wall.z() < kDoorTop_m;
    return in_the_doorway ? 0.1 : paint(on_wall);
  }
  static Rgb8 byte(double grey, double noise) {
    const auto v = static_cast<std::uint8_t>(std::clamp(std::lround(255 * grey + noise), 1L, 255L));
    return {v, v, v};
  }
  double corner(const Eigen::Vector3i& at, unsigned kind) const {
    std::uint32_t h = pattern_ * 0x9E3779B9U + kind;
    for (int k = 0; k < 3; ++k) {
      h ^= static_cast<std::uint32_t>(at[k]) + 0x9E3779B9U + (h << 6) + (h >> 2);
      h *= 0x85EBCA6BU, h ^= h >> 13;
    }
    return static_cast<double>(h & 0xFFFF) / 0xFFFF;
  }
  /// Value noise, smooth between the corners of unit cells.
  double noise(const Eigen::Vector3d& p, unsigned kind) const {
    Eigen::Vector3i cell;
    Eigen::Vector3d f;
    for (int k = 0; k < 3; ++k) {
      cell[k] = static_cast<int>(std::floor(p[k]));
      const double t = p[k] - cell[k];
      f[k] = t * t * (3 - 2 * t);
    }
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const Eigen::Vector3i bit(c & 1, (c >> 1) & 1, c >> 2);
      double share = 1;
      for (int k = 0; k < 3; ++k) share *= bit[k] != 0 ? f[k] : 1 - f[k];
      sum += share * corner(cell + bit, kind);
    }
    return sum;
  }

  unsigned pattern_;
  double contrast_, period_m_;
  Things things_;
};

/// A camera near the middle of the box that looks along y, moved and turned.
inline geometry::Pose in_the_box(const Eigen::Vector3d& place_m, const Eigen::Vector3d& turn_rad) {
  Eigen::Matrix3d axes;
  axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const double angle = turn_rad.norm();
  const Eigen::Vector3d axis =
      angle > 0 ? Eigen::Vector3d(turn_rad / angle) : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)) * Eigen::Quaterniond(axes), place_m};
}

}  // namespace mixrig::test
