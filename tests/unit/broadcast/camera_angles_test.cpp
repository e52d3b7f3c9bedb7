// SPDX-License-Identifier: Apache-2.0
// Compares camera angles with the viewing direction, by the definitions of pan, tilt and roll.
#include "extras/broadcast/packets/camera_angles.h"

#include <cmath>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "host/math/geometry/pose.h"

namespace mixrig::stream {
namespace {

using Eigen::Vector3d;

CameraAngles looking(const Vector3d& along, const Vector3d& up = Vector3d::UnitZ()) {
  return camera_angles(
      geometry::look_at(Vector3d(1, 2, 3), Vector3d(1, 2, 3) + along, up).rotation);
}

TEST(CameraAngles, AreZeroAlongY) {
  const CameraAngles angles = looking({0, 1, 0});
  EXPECT_NEAR(angles.pan_rad, 0, 1e-12);
  EXPECT_NEAR(angles.tilt_rad, 0, 1e-12);
  EXPECT_NEAR(angles.roll_rad, 0, 1e-12);
}

TEST(CameraAngles, ToTheLeftAndUpArePositive) {
  EXPECT_NEAR(looking({-1, std::sqrt(3.0), 0}).pan_rad, 30 * kDeg, 1e-12);
  EXPECT_NEAR(std::abs(looking({0, -1, 0}).pan_rad), M_PI, 1e-9);
  const CameraAngles up = looking({0, 1, 1});
  EXPECT_NEAR(up.tilt_rad, 45 * kDeg, 1e-12);
  EXPECT_NEAR(up.pan_rad, 0, 1e-12);
}

/// Seen from behind, a camera that rolls clockwise has its top to the right.
TEST(CameraAngles, ClockwiseRollIsPositive) {
  const CameraAngles angles = looking({0, 1, 0}, {std::sin(0.3), 0, std::cos(0.3)});
  EXPECT_NEAR(angles.roll_rad, 0.3, 1e-12);
  EXPECT_NEAR(angles.pan_rad, 0, 1e-12);
}

TEST(CameraAngles, GiveTheRotationBack) {
  for (const double pan : {-3.0, -0.4, 0.0, 2.5})
    for (const double tilt : {-1.5, -0.2, 0.0, 1.0})
      for (const double roll : {-3.0, -0.5, 0.0, 1.7}) {
        const CameraAngles again = camera_angles(world_from_camera({pan, tilt, roll}));
        EXPECT_NEAR(again.pan_rad, pan, 1e-9);
        EXPECT_NEAR(again.tilt_rad, tilt, 1e-9);
        EXPECT_NEAR(again.roll_rad, roll, 1e-9);
      }
}

TEST(CameraAngles, StraightDownHasNoRoll) {
  const Eigen::Quaterniond down = world_from_camera({0.7, -M_PI / 2, 0});
  const CameraAngles angles = camera_angles(down);
  EXPECT_EQ(angles.roll_rad, 0);
  EXPECT_LT(world_from_camera(angles).angularDistance(down), 1e-6);
}

}  // namespace
}  // namespace mixrig::stream
