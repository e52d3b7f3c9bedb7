// SPDX-License-Identifier: Apache-2.0
// Planes of a box's walls, and points off them.
#include "host/room/scan/shape/room_planes.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/box_views.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

constexpr Size kRoom{720, 360};

/// A panorama of the box with noise; `nearer_m` moves parts of it towards the origin.
template <typename Nearer>
Panorama noisy_room(double noise_m, const Nearer& nearer_m) {
  Panorama p;
  p.distance_m.reset(kRoom), p.views.reset(kRoom, 1), p.field.reset(kRoom, 1);
  p.sigma_m.reset(kRoom, static_cast<float>(std::max(noise_m, 0.001)));
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int y = 0; y < kRoom.height; ++y)
    for (int x = 0; x < kRoom.width; ++x) {
      const Vector3d ray = direction_of(kRoom, x, y);
      p.distance_m.at(x, y) = static_cast<float>(test::to_wall_m(Vector3d::Zero(), ray) -
                                                 nearer_m(ray) + noise_m * normal(random));
    }
  return p;
}
double nothing(const Vector3d&) { return 0; }

double rms_off_m(const Panorama& p) {
  double sum = 0;
  for (int y = 0; y < kRoom.height; ++y)
    for (int x = 0; x < kRoom.width; ++x)
      sum += std::pow(
          p.distance_m.at(x, y) - test::to_wall_m(Vector3d::Zero(), direction_of(kRoom, x, y)), 2);
  return std::sqrt(sum / static_cast<double>(kRoom.area()));
}

TEST(RoomPlanes, FindsTheSixWallsOfABox) {
  const auto planes = find_planes(noisy_room(0.004, nothing));
  ASSERT_EQ(planes.size(), 6U);
  double sum_sr = 0;
  for (const RoomPlane& plane : planes) {
    const double away_m = 1 / plane.inverse_per_m.norm();
    const Vector3d normal = plane.inverse_per_m * away_m;
    Eigen::Index axis = 0;
    EXPECT_GT(normal.cwiseAbs().maxCoeff(&axis), 1 - 1e-6);
    EXPECT_NEAR(away_m, test::kBoxHalf_m[axis], 0.0005);
    sum_sr += plane.solid_angle_sr;
  }
  EXPECT_GT(sum_sr, 0.85 * 4 * M_PI);
  EXPECT_TRUE(std::is_sorted(planes.begin(), planes.end(), [](const auto& a, const auto& b) {
    return a.solid_angle_sr > b.solid_angle_sr;
  }));
}

TEST(RoomPlanes, StraightWallsLoseTheirNoise) {
  Panorama p = noisy_room(0.004, nothing);
  const double before_m = rms_off_m(p);
  Crew crew(2);
  const Image<std::uint8_t> of_pixel = straighten(find_planes(p), p, crew);
  EXPECT_NEAR(before_m, 0.004, 0.0002);
  EXPECT_LT(rms_off_m(p), 0.3 * before_m);
  int moved = 0;
  for (int y = 0; y < kRoom.height; ++y)
    for (int x = 0; x < kRoom.width; ++x) moved += of_pixel.at(x, y) != kNoPlane;
  EXPECT_GT(moved, 0.95 * static_cast<double>(kRoom.area()));
}

TEST(RoomPlanes, WhatStandsOffAWallStays) {
  // A picture of 1 m^2 on the wall ahead, 12 mm thick: three sigmas.
  const auto picture_m = [](const Vector3d& ray) {
    if (ray.y() <= 0) return 0.0;
    const Vector3d at_m = ray / ray.y() * test::kBoxHalf_m.y();
    const bool inside = std::abs(at_m.x()) < 0.5 && std::abs(at_m.z()) < 0.5;
    return inside ? 0.012 / ray.y() : 0.0;
  };
  Panorama p = noisy_room(0.004, picture_m);
  Crew crew(2);
  straighten(find_planes(p), p, crew);
  double sum_m = 0;
  int count = 0;
  for (int y = 0; y < kRoom.height; ++y)
    for (int x = 0; x < kRoom.width; ++x) {
      const Vector3d ray = direction_of(kRoom, x, y);
      if (picture_m(ray) <= 0) continue;
      const Vector3d at_m = ray / ray.y() * test::kBoxHalf_m.y();
      if (std::max(std::abs(at_m.x()), std::abs(at_m.z())) > 0.4) continue;
      sum_m += (test::to_wall_m(Vector3d::Zero(), ray) - p.distance_m.at(x, y)) * ray.y();
      ++count;
    }
  ASSERT_GT(count, 500);
  EXPECT_NEAR(sum_m / count, 0.012, 0.002);
}

TEST(RoomPlanes, ARoundRoomHasNone) {
  Panorama p = noisy_room(0, nothing);
  p.distance_m.fill(2.0F);
  EXPECT_TRUE(find_planes(p).empty());
  Panorama unknown = p;
  unknown.views.fill(0);
  EXPECT_TRUE(find_planes(unknown).empty());
  Crew crew(1);
  straighten({}, p, crew);
  EXPECT_EQ(p.distance_m.at(5, 5), 2.0F);
}

}  // namespace
}  // namespace mixrig::model
