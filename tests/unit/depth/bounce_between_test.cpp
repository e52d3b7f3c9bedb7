// SPDX-License-Identifier: Apache-2.0
// A corner between two diffuse walls, with the light between them integrated over the walls.
#include "host/capture/depth/bounce_between.h"

#include <cmath>
#include <complex>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"

namespace mixrig::depth {
namespace {

constexpr Size kPicture{176, 144};
constexpr double kFocal_px = 200, kFar_m = 3, kReflectivity = 0.6, kModulation_hz = 20e6;
const geometry::CameraModel kSensor{{kPicture, kFocal_px, kFocal_px, 87.5, 71.5}, {}};

Eigen::Vector3d sensor_ray(double x, double y) {
  return {(x - 87.5) / kFocal_px, (y - 71.5) / kFocal_px, 1};
}

/// The walls |x| + z = kFar_m.
Eigen::Vector3d wall_point(const Eigen::Vector3d& ray) {
  return kFar_m / (1 + std::abs(ray.x())) * ray;
}

/// Irradiance from the light source, 1 at 1 m and at right angles.
double light_at(const Eigen::Vector3d& p, const Eigen::Vector3d& inward) {
  return std::max(0.0, -inward.dot(p)) / std::pow(p.norm(), 3);
}

/// By how much the other wall's light lengthens the distance of a point on one wall. Every second
/// pixel of that wall in both directions sends its light.
double lengthening_m(const Eigen::Vector3d& p) {
  const double side = p.x() < 0 ? -1 : 1, wave = 2 * M_PI * kModulation_hz / 299792458.0;
  const Eigen::Vector3d here = Eigen::Vector3d(-side, 0, -1).normalized(),
                        there = Eigen::Vector3d(side, 0, -1).normalized();
  std::complex<double> sum = 0;
  for (double y = 0.5; y < kPicture.height; y += 2)
    for (double x = 0.5; x < kPicture.width; x += 2) {
      const Eigen::Vector3d ray = sensor_ray(x, y);
      if (ray.x() * side >= 0) continue;
      const Eigen::Vector3d q = wall_point(ray), way = p - q;
      const double area = 4 / (kFocal_px * kFocal_px) * q.z() * q.z() / -there.dot(ray);
      const double exchange =
          there.dot(way) * -here.dot(way) / (M_PI * std::pow(way.squaredNorm(), 2));
      sum += kReflectivity * light_at(q, there) * exchange * area *
             std::polar(1.0, wave * (q.norm() + way.norm() - p.norm()));
    }
  return std::arg(1.0 + sum / light_at(p, here)) / (2 * wave);
}

struct CornerPictures {
  Image<float> true_m{kPicture}, seen_m{kPicture};
};

const CornerPictures& corner() {
  static const CornerPictures pictures = [] {
    CornerPictures made;
    // The corner is symmetric about both axes of the picture.
    for (const auto [x, y] : test::each_pixel({kPicture.width / 2, kPicture.height / 2})) {
      const Eigen::Vector3d p = wall_point(sensor_ray(x, y));
      const double longer = 1 + lengthening_m(p) / p.norm();
      for (const int u : {x, kPicture.width - 1 - x})
        for (const int v : {y, kPicture.height - 1 - y}) {
          made.true_m.at(u, v) = static_cast<float>(p.z());
          made.seen_m.at(u, v) = static_cast<float>(p.z() * longer);
        }
    }
    return made;
  }();
  return pictures;
}

/// Root mean square of the depth error, 0.1 m off the corner and more.
double error_m(const Image<float>& z_m) {
  double squares = 0;
  int count = 0;
  for (const auto [x, y] : test::each_pixel(kPicture)) {
    if (std::abs(sensor_ray(x, y).x()) * kFar_m < 0.07) continue;
    squares += std::pow(z_m.at(x, y) - corner().true_m.at(x, y), 2), ++count;
  }
  return std::sqrt(squares / count);
}

TEST(BounceBetween, LightBetweenTwoWallsIsTakenOut) {
  const PixelRays rays(kSensor);
  Image<float> z_m = corner().seen_m;
  const double before_m = error_m(z_m);
  EXPECT_GT(before_m, 0.02) << "the walls light each other";
  take_out_bounce({kModulation_hz, kReflectivity}, rays, z_m);
  EXPECT_LT(error_m(z_m), 0.15 * before_m);
  Image<float> unchanged = corner().seen_m;
  take_out_bounce({kModulation_hz, 0}, rays, unchanged);
  EXPECT_EQ(error_m(unchanged), before_m);
}

TEST(BounceBetween, UnknownDepthsStayUnknown) {
  const PixelRays rays(kSensor);
  Image<float> z_m = corner().seen_m;
  for (int y = 20; y < 60; ++y) z_m.at(30, y) = 0, z_m.at(31, y) = NAN;
  take_out_bounce({kModulation_hz, kReflectivity}, rays, z_m);
  for (int y = 20; y < 60; ++y) EXPECT_TRUE(z_m.at(30, y) == 0 && std::isnan(z_m.at(31, y)));
  Image<float> dark(kPicture);
  take_out_bounce({kModulation_hz, kReflectivity}, rays, dark);
  for (const auto [x, y] : test::each_pixel(kPicture)) ASSERT_EQ(dark.at(x, y), 0);
}

TEST(BounceBetween, CornersTellTheReflectivityOrNothing) {
  const PixelRays rays(kSensor);
  const std::vector<Image<float>> seen(5, corner().seen_m), square(5, corner().true_m),
      few(4, corner().seen_m);
  EXPECT_NEAR(find_reflectivity(seen, rays, kModulation_hz).value_or(0), kReflectivity, 0.15)
      << "cells at the corner are coarse, which takes out too much there";
  EXPECT_LT(corner_error(seen, rays).error_m, -0.01) << "the corner is seen too near";
  EXPECT_FALSE(find_reflectivity(few, rays, kModulation_hz)) << "too few corners";
  EXPECT_FALSE(find_reflectivity(square, rays, kModulation_hz)) << "no light bounces";
}

}  // namespace
}  // namespace mixrig::depth
