// SPDX-License-Identifier: Apache-2.0
// Metres of a map from depth pictures of a wall whose distance is known.
#include "extras/map/reconstruction/growth/map_scale.h"

#include <random>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

constexpr double kMetresPerUnit = 2.5, kWall_m = 3;

/// Places on a wall before the camera, in units; pictures show them at 0.2 s.
std::vector<reconstruction::SeenPlace> wall_places() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<reconstruction::SeenPlace> places;
  for (int i = 0; i < 200; ++i)
    places.push_back(
        {Eigen::Vector3d(unit(random), unit(random), kWall_m) / kMetresPerUnit, {0.2}});
  return places;
}

/// The camera stands still.
trajectory::Trajectory path_at_rest() {
  std::vector<trajectory::TimedPose> path;
  for (int i = 0; i < 9; ++i) path.push_back({0.1 * i, {}});
  return trajectory::Trajectory(path);
}

auto scale_of(const std::vector<reconstruction::DepthView>& views,
              const reconstruction::DepthCamera& camera) {
  return reconstruction::scale_by_depth(wall_places(), path_at_rest(), {views, camera});
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
  const auto fit = scale_of({view}, depth_camera_beside());
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->metres_per_unit, kMetresPerUnit, 0.002);
  EXPECT_LT(fit->scale.sigma, 0.01);
}

TEST(MapScale, WhoStandsBeforeAWallThatNoPictureShowsIsNotTheWall) {
  // Someone fills the picture 0.6 s later, when nobody sees the places.
  const reconstruction::DepthView wall{0.2,
                                       Image<float>({160, 120}, static_cast<float>(kWall_m + 0.3))};
  const reconstruction::DepthView person{0.8, Image<float>({160, 120}, 1.5F)};
  const auto fit = scale_of({wall, person, person, person}, depth_camera_beside());
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->metres_per_unit, kMetresPerUnit, 0.002);
}

TEST(MapScale, IsThatOfMostPlacesWhereTheOthersAreAllTooNear) {
  // At a third of the points an object is 0.1 to 0.5 m before the wall.
  reconstruction::DepthView view{0.2, Image<float>({160, 120}, static_cast<float>(kWall_m + 0.3))};
  for (int y = 0; y < 120; ++y)
    for (int x = 46; x < 67; ++x)
      view.depth_m.at(x, y) -= 0.1F + 0.4F * static_cast<float>(x - 46) / 20;
  const auto fit = scale_of({view}, depth_camera_beside());
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->metres_per_unit, kMetresPerUnit, 0.01);
}

TEST(MapScale, IsUnknownWithoutDepth) {
  const reconstruction::DepthView view{0.2, Image<float>({160, 120})};
  EXPECT_FALSE(scale_of({view}, depth_camera_beside()));
  EXPECT_FALSE(scale_of({}, depth_camera_beside()));
}

}  // namespace
}  // namespace mixrig
