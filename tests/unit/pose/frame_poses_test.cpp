// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/frame_poses.h"

#include <gtest/gtest.h>

#include "host/pose/source/fixed_poses.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/pose/swing.h"

namespace mixrig::pose {
namespace {

using capture::CameraPose;
using capture::PoseLoss;

/// Returns the poses that the test has set.
class ScriptedPoses final : public capture::PoseSource {
 public:
  ScriptedPoses() : PoseSource({"scripted", "scripted"}) {}
  CameraPose next;
  CameraPose pose_of(const capture::Capture&) override { return next; }
};

CameraPose at_x(double x_m, double age_s = 0) {
  CameraPose pose;
  pose.world_from_target.translation_m.x() = x_m;
  pose.age_s = age_s;
  return pose;
}

TEST(FramePoses, FreezesAtTheLastPoseAndCountsWhy) {
  ScriptedPoses source;
  FramePoses poses(source, {0.1, WhenLost::kFreeze});
  source.next = at_x(1, 0.099);
  EXPECT_TRUE(poses.next(capture_at(0)).camera.ok());
  struct Row {
    CameraPose pose;
    PoseLoss loss;
  };
  const Row rows[] = {{CameraPose::lost(PoseLoss::kGap), PoseLoss::kGap},
                      {at_x(9, 0.101), PoseLoss::kTooOld},
                      {at_x(NAN), PoseLoss::kNotFinite},
                      {at_x(9, NAN), PoseLoss::kNotFinite}};
  for (const Row& row : rows) {
    source.next = row.pose;
    const FramePose frame = poses.next(capture_at(0.04));
    EXPECT_EQ(frame.camera.loss, row.loss);
    EXPECT_EQ(frame.camera.world_from_target.translation_m.x(), 1);
    EXPECT_TRUE(frame.objects_shown);
  }
  EXPECT_EQ(poses.counts().frames[0], 1U);
  EXPECT_EQ(poses.counts().lost(), 4U);
  EXPECT_EQ(poses.counts().frames[static_cast<std::size_t>(PoseLoss::kNotFinite)], 2U);
  source.next = at_x(1.02);
  EXPECT_EQ(poses.next(capture_at(0.08)).camera.world_from_target.translation_m.x(), 1.02);
}

TEST(FramePoses, HidesObjectsWhereTheSceneSaysSoAndBeforeTheFirstPose) {
  for (const WhenLost when : {WhenLost::kFreeze, WhenLost::kHide}) {
    ScriptedPoses source;
    FramePoses poses(source, {0.1, when});
    source.next = CameraPose::lost(PoseLoss::kOutside);
    EXPECT_FALSE(poses.next(capture_at(0)).objects_shown) << "nowhere to be yet";
    source.next = at_x(1);
    EXPECT_TRUE(poses.next(capture_at(0.04)).objects_shown);
    source.next = CameraPose::lost(PoseLoss::kOutside);
    EXPECT_EQ(poses.next(capture_at(0.08)).objects_shown, when == WhenLost::kFreeze);
  }
}

TEST(FramePoses, CountsJumpsBetweenFrames) {
  ScriptedPoses source;
  FramePoses poses(source, {});
  const double x_m[] = {0, 0.1, 0.2, 1.2, 1.3};
  for (int k = 0; k < 5; ++k) {
    source.next = at_x(x_m[k]);
    poses.next(capture_at(0.04 * k));
  }
  EXPECT_EQ(poses.counts().jumps, 1U);
}

TEST(FramePoses, AFrameAllocatesNothing) {
  ScriptedPoses source;
  source.next = at_x(1);
  FramePoses poses(source, {});
  const auto capture = capture_at(0);
  const long before = test::allocations;
  for (int i = 0; i < 10; ++i) (void)poses.next(capture);
  EXPECT_EQ(test::allocations, before);
}

TEST(OwnPoses, AnUnknownPoseIsTheIdentityUnlessRecordedOnesAreWanted) {
  auto capture = capture_at(0);
  capture.world_from_target.translation_m.x() = 2;
  for (const auto origin : {capture::PoseOrigin::kUnknown, capture::PoseOrigin::kFixed,
                            capture::PoseOrigin::kRecorded}) {
    capture.pose_origin = origin;
    const auto any = make_own_poses(false)->pose_of(capture);
    EXPECT_TRUE(any.ok());
    EXPECT_EQ(any.world_from_target.translation_m.x(), 2);
    const auto recorded = make_own_poses(true)->pose_of(capture);
    EXPECT_EQ(recorded.loss,
              origin == capture::PoseOrigin::kRecorded ? PoseLoss::kNone : PoseLoss::kAbsent);
  }
}

TEST(FixedPose, IsThatOfEveryCapture) {
  const auto poses = make_fixed_pose(swing(0.3), "fixed", "fixed by the scene");
  EXPECT_EQ(poses->pose_of(capture_at(7)).world_from_target.matrix(), swing(0.3).matrix());
  EXPECT_FALSE(poses->info().moves);
}

}  // namespace
}  // namespace mixrig::pose
