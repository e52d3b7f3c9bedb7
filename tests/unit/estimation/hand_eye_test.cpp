// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/hand_eye.h"

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

struct Rig {
  std::vector<Pose> hands, eyes;
  HandEye truth;
};

/// Views at `turns` (rotation vectors of the hand), with noise in the eye's poses.
Rig rig_of(const std::vector<Vector3d>& turns, double noise_rad, double noise_m) {
  test::RandomGeometry random(7);
  Rig rig;
  rig.truth = {{rotation_exp({0.2, -1.2, 0.4}), {0.05, 0.02, 0.1}},
               {rotation_exp({2.0, 0.1, 0.3}), {0.5, 1.0, 2.0}}};
  for (const Vector3d& turn : turns) {
    const Pose hand{rotation_exp(turn), random.in_box(0.5)};
    Pose eye = geometry::inverse(hand * rig.truth.hand_from_eye) * rig.truth.world_from_target;
    eye.rotation = rotation_exp(random.normal3(noise_rad)) * eye.rotation;
    eye.translation_m += random.normal3(noise_m);
    rig.hands.push_back(hand);
    rig.eyes.push_back(eye);
  }
  return rig;
}

std::vector<Vector3d> turns(int count) {
  test::RandomGeometry random(8);
  return random.cloud(count, 0.6);
}

TEST(SolveHandEye, RecoversAnExactChain) {
  const Rig rig = rig_of(turns(8), 0, 0);
  const auto fit = solve_hand_eye(rig.hands, rig.eyes);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_LT(pose_error(fit.value.hand_from_eye, rig.truth.hand_from_eye).norm(), 1e-9);
  EXPECT_LT(pose_error(fit.value.world_from_target, rig.truth.world_from_target).norm(), 1e-9);
}

TEST(SolveHandEye, LeavesAWrongViewOut) {
  Rig rig = rig_of(turns(12), 1e-3, 1e-3);
  rig.eyes[4].translation_m.x() += 0.1;
  const auto fit = solve_hand_eye(rig.hands, rig.eyes);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_EQ(fit.inliers.size(), 11u);
  EXPECT_LT(pose_error(fit.value.hand_from_eye, rig.truth.hand_from_eye).norm(), 0.01);
}

TEST(SolveHandEye, RefusesTurnsAboutOneAxisAndNone) {
  std::vector<Vector3d> one_axis;
  for (int i = 0; i < 10; ++i) one_axis.push_back({0, 0, 0.1 * i});
  const Rig rig = rig_of(one_axis, 1e-4, 1e-4);
  const auto fit = solve_hand_eye(rig.hands, rig.eyes);
  EXPECT_FALSE(fit.usable());
  EXPECT_NE(fit.verdict.reason.find("second axis"), std::string::npos) << fit.verdict.reason;
  const Rig still = rig_of(std::vector<Vector3d>(6, Vector3d(0.1, 0.2, 0.3)), 1e-4, 1e-4);
  EXPECT_FALSE(solve_hand_eye(still.hands, still.eyes).usable());
}

TEST(SolveHandEye, RefusesTooFewUnrelatedAndBrokenPoses) {
  const Rig two = rig_of(turns(2), 0, 0);
  EXPECT_FALSE(solve_hand_eye(two.hands, two.eyes).usable());
  Rig rig = rig_of(turns(8), 0, 0);
  test::RandomGeometry random(9);
  for (Pose& eye : rig.eyes) eye = random.pose(1.0);
  EXPECT_FALSE(solve_hand_eye(rig.hands, rig.eyes).usable());
  rig = rig_of(turns(8), 0, 0);
  rig.hands[2].translation_m.z() = NAN;
  EXPECT_FALSE(solve_hand_eye(rig.hands, rig.eyes).usable());
}

}  // namespace
}  // namespace mixrig::estimation
