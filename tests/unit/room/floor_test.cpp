// SPDX-License-Identifier: Apache-2.0
// The floor of made rooms, against the plane that they were made with.
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "host/math/geometry/pose.h"
#include "host/room/background/static_background.h"

namespace mixrig::model {
namespace {

const geometry::Pinhole kFloorView{{320, 240}, 270, 270, 159.5, 119.5};

/// World z up. A camera 1.6 m above the floor, pitched down and rolled.
geometry::Pose world_from_camera(double pitch_deg, double roll_deg) {
  geometry::Pose level = geometry::look_at({0, 0, 1.6}, {0, 5, 1.6}, {0, 0, 1});
  const double to_rad = M_PI / 180;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-pitch_deg * to_rad, Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(roll_deg * to_rad, Eigen::Vector3d::UnitZ()));
  return level * geometry::Pose{turn, {0, 0, 0}};
}

/// First hit of a ray from the camera with floor z = 0, a wall y = 5, and, if wanted, a table.
double hit(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray, bool table) {
  double best = std::numeric_limits<double>::infinity();
  if (ray.z() < 0) best = -eye.z() / ray.z();
  if (ray.y() > 0) best = std::min(best, (5 - eye.y()) / ray.y());
  if (table && ray.z() < 0) {
    const double t = (0.75 - eye.z()) / ray.z();
    const Eigen::Vector3d p = eye + t * ray;
    if (std::abs(p.x()) < 1.2 && p.y() > 1.0 && p.y() < 3.5) best = std::min(best, t);
  }
  return best;
}

Image<float> render(const geometry::Pose& pose, bool table, double outlier_share, double noise_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0, 1), anywhere_m(0.5, 8);
  std::normal_distribution<double> noise(0, noise_m);
  Image<float> depth_m(kFloorView.size_px);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const Eigen::Vector2d r = kFloorView.unproject({x, y});
      const double z =
          hit(pose.translation_m, pose.rotation * Eigen::Vector3d(r.x(), r.y(), 1), table);
      if (std::isfinite(z)) depth_m.at(x, y) = static_cast<float>(z + noise(random));
      if (share(random) < outlier_share) depth_m.at(x, y) = static_cast<float>(anywhere_m(random));
    }
  return depth_m;
}

void expect_floor(const std::optional<geometry::Plane>& floor, const geometry::Pose& pose,
                  double angle_deg, double height_m) {
  ASSERT_TRUE(floor);
  const Eigen::Vector3d up = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const double angle = std::acos(std::min(1.0, floor->normal.dot(up))) * 180 / M_PI;
  EXPECT_LT(angle, angle_deg);
  EXPECT_NEAR(floor->offset_m, 1.6, height_m) << "the camera's height";
}

TEST(FindFloor, OfATiltedCameraIsThePlaneOfTheRoom) {
  for (const auto& [pitch, roll] :
       {std::pair(10.0, 0.0), std::pair(25.0, 8.0), std::pair(40.0, -15.0)}) {
    const auto pose = world_from_camera(pitch, roll);
    expect_floor(find_floor(kFloorView, render(pose, false, 0.0, 0.005)), pose, 0.2, 0.01);
  }
}

TEST(FindFloor, LiesBelowALargeTable) {
  const auto pose = world_from_camera(25, 3);
  expect_floor(find_floor(kFloorView, render(pose, true, 0.0, 0.005)), pose, 0.5, 0.02);
}

TEST(FindFloor, StandsThirtyPercentOfOutliers) {
  const auto pose = world_from_camera(25, -5);
  expect_floor(find_floor(kFloorView, render(pose, true, 0.3, 0.01)), pose, 1.0, 0.03);
}

TEST(FindFloor, IsAbsentWhereOnlyAWallOrNothingIsSeen) {
  EXPECT_FALSE(find_floor(kFloorView, Image<float>(kFloorView.size_px, 3.0F)));
  EXPECT_FALSE(find_floor(kFloorView, Image<float>(kFloorView.size_px)));
  EXPECT_FALSE(find_floor(kFloorView, Image<float>(kFloorView.size_px, std::nanf(""))));
}

TEST(FindFloor, DoesNotTakeTheCeilingForIt) {
  const auto pose = world_from_camera(-35, 0);
  Image<float> depth_m(kFloorView.size_px);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const Eigen::Vector2d r = kFloorView.unproject({x, y});
      const Eigen::Vector3d ray = pose.rotation * Eigen::Vector3d(r.x(), r.y(), 1);
      if (ray.z() > 0.2) depth_m.at(x, y) = static_cast<float>(1.4 / ray.z());
    }
  EXPECT_FALSE(find_floor(kFloorView, depth_m));
}

}  // namespace
}  // namespace mixrig::model
