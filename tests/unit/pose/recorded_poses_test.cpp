// SPDX-License-Identifier: Apache-2.0
// A trajectory file beside a take of another rate and another clock, against the motion in closed
// form.
#include "host/pose/source/recorded_poses.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/pose/swing.h"

namespace mixrig::pose {
namespace {

using capture::PoseLoss;
using trajectory::TimedPose;

constexpr double kRecorderClock_s = 812.375;  // the recorder's clock when the take's reads 0

std::unique_ptr<RecordedPoses> poses_of(const std::vector<TimedPose>& samples) {
  auto poses = RecordedPoses::make(samples, {"mocap.txt", -kRecorderClock_s});
  EXPECT_TRUE(poses) << poses.error().context;
  return poses ? *std::move(poses) : nullptr;
}

std::vector<TimedPose> mocap(double from_s, double to_s) {
  return swing_samples(from_s, to_s, 120, kRecorderClock_s);
}

TEST(RecordedPoses, AreFoundByTimeNotByNumber) {
  const auto poses = poses_of(mocap(-1.003, 9));
  double worst_rad = 0, worst_m = 0, by_index_m = 0;
  for (int k = 0; k < 200; ++k) {
    const double t_s = k / 25.0;
    const auto pose = poses->pose_of(capture_at(t_s, k + 1));
    ASSERT_TRUE(pose.ok()) << t_s;
    const auto error = distance(pose.world_from_target, swing(t_s));
    worst_rad = std::max(worst_rad, error.turn_rad), worst_m = std::max(worst_m, error.shift_m);
    by_index_m = std::max(by_index_m, distance(swing(-1.003 + k / 120.0), swing(t_s)).shift_m);
    EXPECT_LE(pose.age_s, 0.5 / 120 + 1e-9);
    EXPECT_FALSE(pose.covariance);
  }
  // A cubic between samples h apart is off by at most (3/128) h^4 times the fourth derivative.
  const double h_s = 1 / 120.0, w = std::numbers::pi;
  EXPECT_LT(worst_m, 3.0 / 128 * std::pow(h_s, 4) * 0.4 * std::pow(w, 4) + 1e-12);
  EXPECT_LT(worst_rad, 1e-6);
  EXPECT_GT(by_index_m, 0.5) << "what taking poses by number would cost";
}

TEST(RecordedPoses, ThereIsNoneOutsideAndInGaps) {
  auto samples = mocap(0.5, 4);
  // No samples from 2.0 to 2.2 s of the take.
  std::erase_if(samples, [](const TimedPose& s) {
    return s.t_s > kRecorderClock_s + 2.001 && s.t_s < kRecorderClock_s + 2.199;
  });
  const auto poses = poses_of(samples);
  EXPECT_EQ(poses->pose_of(capture_at(0.49)).loss, PoseLoss::kOutside);
  EXPECT_TRUE(poses->pose_of(capture_at(0.5)).ok());
  EXPECT_TRUE(poses->pose_of(capture_at(0.5 - 5e-7)).ok()) << "rounded in the file";
  EXPECT_TRUE(poses->pose_of(capture_at(poses->span_s().second + 5e-7)).ok());
  EXPECT_TRUE(poses->pose_of(capture_at(1.99)).ok());
  for (double t_s : {2.01, 2.1, 2.19})
    EXPECT_EQ(poses->pose_of(capture_at(t_s)).loss, PoseLoss::kGap);
  EXPECT_TRUE(poses->pose_of(capture_at(2.21)).ok());
  EXPECT_EQ(poses->pose_of(capture_at(4.02)).loss, PoseLoss::kOutside);
  EXPECT_EQ(poses->pose_of(capture_at(NAN)).loss, PoseLoss::kOutside);
  EXPECT_NEAR(poses->span_s().first, 0.5, 1e-9);
  EXPECT_NEAR(poses->span_s().second, 4, 1e-9);
}

TEST(RecordedPoses, WrongSamplesDoNotReachThePicture) {
  auto samples = mocap(0, 4);
  samples[120].world_from_body.translation_m.x() += 0.8;
  samples[240].world_from_body.translation_m.y() = NAN;
  const auto poses = poses_of(samples);
  for (double t_s = 0.8; t_s < 2.2; t_s += 0.003) {
    const auto pose = poses->pose_of(capture_at(t_s));
    ASSERT_TRUE(pose.ok()) << t_s;
    EXPECT_LT(distance(pose.world_from_target, swing(t_s)).shift_m, 1e-5) << t_s;
  }
  EXPECT_EQ(poses->faults().jumps, 1U);
  EXPECT_EQ(poses->faults().not_finite, 1U);
}

TEST(RecordedPoses, NothingIsInterpolatedAcrossAJump) {
  auto samples = mocap(0, 4);
  for (auto& sample : samples)
    if (sample.t_s > kRecorderClock_s + 2.001) sample.world_from_body.translation_m.x() += 0.8;
  const auto poses = poses_of(samples);
  const Eigen::Vector3d moved(0.8, 0, 0);
  for (double t_s = 1.9; t_s < 2.1; t_s += 0.0007) {
    const auto pose = poses->pose_of(capture_at(t_s));
    const bool across = t_s > 2.00005 && t_s < 2.0082;
    EXPECT_EQ(pose.loss, across ? PoseLoss::kJump : PoseLoss::kNone) << t_s;
    if (across) continue;
    geometry::Pose truth = swing(t_s);
    if (t_s > 2.001) truth.translation_m += moved;
    EXPECT_LT(distance(pose.world_from_target, truth).shift_m, 1e-5) << t_s;
  }
  EXPECT_EQ(poses->faults().jumps, 1U);
}

TEST(RecordedPoses, RefusesWhatIsNoTrajectoryOfOneClock) {
  auto samples = mocap(0, 1);
  for (std::size_t i = 60; i < samples.size(); ++i) samples[i].t_s -= 3;
  samples[59].t_s = NAN;
  const auto stepped = RecordedPoses::make(samples, {"mocap.txt", 0});
  ASSERT_FALSE(stepped);
  EXPECT_EQ(stepped.error().code, ErrorCode::kData);
  EXPECT_NE(stepped.error().context.find("mocap.txt: time runs backwards from 812.858"),
            std::string::npos)
      << stepped.error().context;
  for (auto& sample : samples) sample.world_from_body.translation_m.x() = NAN;
  std::sort(samples.begin(), samples.end(), [](auto& a, auto& b) { return a.t_s < b.t_s; });
  EXPECT_FALSE(RecordedPoses::make({}, {"mocap.txt", 0}));
  for (auto& sample : samples) sample.t_s = 1;
  EXPECT_FALSE(RecordedPoses::make(samples, {"mocap.txt", 0}));
}

TEST(RecordedPoses, AreReadFromAFileThatMayHoldNaN) {
  const test::TemporaryFolder folder;
  std::string text = "t,x,y,z,qx,qy,qz,qw\n";
  for (const TimedPose& s : swing_samples(0, 1, 120)) {
    const auto& q = s.world_from_body.rotation;
    const auto& p = s.world_from_body.translation_m;
    text += fmt::format("{:.9f},{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}\n", s.t_s,
                        p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  }
  text += "1.1,nan,0,0,0,0,0,1\n";
  const auto poses = RecordedPoses::open(folder.write("mocap.csv", text), {"mocap.csv", 0});
  ASSERT_TRUE(poses) << poses.error().context;
  EXPECT_EQ((*poses)->faults().not_finite, 1U);
  EXPECT_LT(distance((*poses)->pose_of(capture_at(0.52)).world_from_target, swing(0.52)).shift_m,
            1e-6);
  EXPECT_NE((*poses)->info().description.find("121 poses at 120.0 Hz"), std::string::npos)
      << (*poses)->info().description;
}

TEST(RecordedPoses, APoseOfAFrameAllocatesNothing) {
  const auto poses = poses_of(mocap(0, 4));
  const auto capture = capture_at(2.013);
  const long before = test::allocations;
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(poses->pose_of(capture).ok());
  EXPECT_EQ(test::allocations, before);
}

}  // namespace
}  // namespace mixrig::pose
