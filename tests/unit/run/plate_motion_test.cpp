// SPDX-License-Identifier: Apache-2.0
// The camera's motion while a plate is exposed, derived from the poses of frames.
#include "host/run/loop/plate_motion.h"

#include <gtest/gtest.h>

namespace mixrig::session {
namespace {

constexpr double kPeriod_s = 0.04, kExposure_s = 0.008;

/// Turns about its y axis at a rate that grows evenly, and moves along x.
capture::CameraPose pose_at(double t_s) {
  const double angle = 0.5 * t_s + 1.5 * t_s * t_s;
  capture::CameraPose pose;
  pose.world_from_target = {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())),
                            {0.3 * t_s, 0, 0}};
  return pose;
}

TEST(PlateMotion, FollowsAnAcceleratingCamera) {
  PlateMotion motion(kExposure_s);
  EXPECT_FALSE(motion.next(pose_at(0), 0));
  std::optional<render::CameraMotion> found;
  for (int i = 1; i <= 3; ++i) found = motion.next(pose_at(i * kPeriod_s), i * kPeriod_s);
  ASSERT_TRUE(found);
  const double t_s = 3 * kPeriod_s, angle = 0.5 * t_s + 1.5 * t_s * t_s;
  // Points of the room go the other way than the camera.
  EXPECT_NEAR(found->turn_rad.y, -kExposure_s * (0.5 + 3 * t_s), 2e-5);
  EXPECT_NEAR(found->turn_rad.x, 0, 1e-6);
  EXPECT_NEAR(found->shift_m.x, -kExposure_s * 0.3 * std::cos(angle), 4e-5);
  EXPECT_NEAR(found->shift_m.z, -kExposure_s * 0.3 * std::sin(angle), 4e-5);
}

TEST(PlateMotion, IsNotKnownWithoutPosesOrExposure) {
  PlateMotion motion(kExposure_s), without;
  (void)motion.next(pose_at(0), 0), (void)without.next(pose_at(0), 0);
  EXPECT_FALSE(without.next(pose_at(0.04), 0.04));
  EXPECT_TRUE(motion.next(pose_at(0.04), 0.04));
  EXPECT_FALSE(motion.next(capture::CameraPose::lost(capture::PoseLoss::kGap), 0.08));
  EXPECT_FALSE(motion.next(pose_at(0.12), 0.12)) << "nothing is known of the step before";
  EXPECT_TRUE(motion.next(pose_at(0.16), 0.16));
  EXPECT_FALSE(motion.next(pose_at(0.60), 0.60)) << "after a gap";
  EXPECT_FALSE(motion.next(pose_at(0.60), 0.60)) << "no time has passed";
}

}  // namespace
}  // namespace mixrig::session
