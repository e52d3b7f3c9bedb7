// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/world_frame.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::session {
namespace {

TEST(WorldOnFloor, OfALevelCameraHasItsHeightAndAxes) {
  // 1.5 m above the floor, looking level: camera y is down.
  const geometry::Plane floor{{0, -1, 0}, 1.5};
  const geometry::Pose world_from_camera = world_from_camera_on_floor(floor);
  EXPECT_TRUE((world_from_camera * Eigen::Vector3d(0, 0, 0)).isApprox(Eigen::Vector3d(0, 0, 1.5)));
  // 1 m right, 1.5 m down, 4 m ahead: on the floor, x right, y ahead.
  const Eigen::Vector3d p = world_from_camera * Eigen::Vector3d(1, 1.5, 4);
  EXPECT_NEAR((p - Eigen::Vector3d(1, 4, 0)).norm(), 0.0, 1e-12);
}

TEST(WorldOnFloor, OfACameraThatLooksDownKeepsTheFloorAtZero) {
  // Tilted down by 30 degrees at 2 m: the optical axis meets the floor 2 / tan 30 = 3.4641 m ahead.
  const double tilt = M_PI / 6;
  const geometry::Plane floor{{0, -std::cos(tilt), -std::sin(tilt)}, 2.0};
  const geometry::Pose world_from_camera = world_from_camera_on_floor(floor);
  const Eigen::Vector3d hit = world_from_camera * Eigen::Vector3d(0, 0, 4.0);
  EXPECT_NEAR((hit - Eigen::Vector3d(0, 2.0 / std::tan(tilt), 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(world_from_camera.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(WorldOnFloor, OfARolledCameraKeepsXLevel) {
  const double roll = 0.2;
  const geometry::Plane floor{{std::sin(roll), -std::cos(roll), 0}, 1.0};
  const geometry::Pose world_from_camera = world_from_camera_on_floor(floor);
  EXPECT_NEAR((world_from_camera.rotation * floor.normal - Eigen::Vector3d(0, 0, 1)).norm(), 0,
              1e-12);
  EXPECT_NEAR(
      (world_from_camera.rotation * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(0, 1, 0)).norm(), 0,
      1e-12);
}

TEST(WorldOnFloor, OfACameraThatLooksStraightDownTakesTheTopOfThePictureAsAhead) {
  const geometry::Plane floor{{0, 0, -1}, 3.0};
  const geometry::Pose world_from_camera = world_from_camera_on_floor(floor);
  const Eigen::Vector3d p = world_from_camera * Eigen::Vector3d(0.5, -1, 3);  // right, towards top
  EXPECT_NEAR((p - Eigen::Vector3d(0.5, 1, 0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace mixrig::session
