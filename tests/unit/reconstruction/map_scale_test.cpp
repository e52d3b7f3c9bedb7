// SPDX-License-Identifier: Apache-2.0
// Metres of a map from depth pictures of a wall whose distance is known.
#include "host/reconstruction/map_scale.h"

#include <random>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

constexpr double kMetresPerUnit = 2.5, kWall_m = 3;

/// Points on a wall before the camera at rest, in units.
reconstruction::LearnedMap wall_map() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  reconstruction::LearnedMap map;
  for (int i = 0; i < 200; ++i) {
    reconstruction::MapPoint point;
    point.place = Eigen::Vector3d(unit(random), unit(random), kWall_m) / kMetresPerUnit;
    map.points.push_back(point);
  }
  for (int i = 0; i < 5; ++i) map.path.push_back({0.1 * i, {}});
  return map;
}

reconstruction::DepthCamera depth_camera_beside() {
  geometry::CameraModel model;
  model.pinhole = {{160, 120}, 100, 100, 80, 60};
  // 0.2 m beside, and 0.3 m behind the camera of the map.
  return {model, {Eigen::Quaterniond::Identity(), {-0.2, 0, 0.3}}, false};
}

TEST(MapScale, IsThatOfTheDepthWhereTheDepthCameraSitsElsewhere) {
  reconstruction::DepthView view{0.2, Image<float>({160, 120}, static_cast<float>(kWall_m + 0.3))};
  // A tenth of the picture shows someone nearer.
  for (int y = 0; y < 120; ++y)
    for (int x = 70; x < 86; ++x) view.depth_m.at(x, y) = 1.5F;
  const auto fit =
      reconstruction::scale_by_depth(wall_map(), std::vector{view}, depth_camera_beside());
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->metres_per_unit, kMetresPerUnit, 0.002);
  EXPECT_LT(fit->scale.sigma, 0.01);
}

TEST(MapScale, IsUnknownWithoutDepth) {
  const reconstruction::DepthView view{0.2, Image<float>({160, 120})};
  EXPECT_FALSE(
      reconstruction::scale_by_depth(wall_map(), std::vector{view}, depth_camera_beside()));
  EXPECT_FALSE(reconstruction::scale_by_depth(wall_map(), {}, depth_camera_beside()));
}

}  // namespace
}  // namespace mixrig
