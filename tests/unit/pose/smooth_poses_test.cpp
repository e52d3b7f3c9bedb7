// SPDX-License-Identifier: Apache-2.0
// Poses of motions that have a formula, with noise.
#include "host/pose/source/smooth_poses.h"

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"

namespace mixrig::pose {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr double kStep_s = 0.1, kSigma_m = 5e-4, kSigma_rad = 2e-4;
constexpr int kReach = 3;  ///< poses before and after
const Vector3d kAxis = Vector3d(0.2, -0.3, 1).normalized();

/// A way along a line and a turn about an axis, both by the same function of time.
Pose moved(double way) {
  return {
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d::UnitX())) * Eigen::AngleAxisd(way, kAxis),
      Vector3d(1, 2, 0.5) + way * Vector3d(0.6, 0, 0.8)};
}

class Motion {
 public:
  explicit Motion(std::function<double(double)> way, double noise = 1)
      : way_(std::move(way)), noise_(noise) {
    for (int i = 0; i < 41; ++i) poses_.push_back(measured(i * kStep_s));
  }
  Pose truth(double t_s) const { return moved(way_(t_s)); }
  std::span<const MeasuredPose> around(int i) const {
    return std::span(poses_).subspan(static_cast<std::size_t>(i - kReach), 2 * kReach + 1);
  }
  Vector3d shift(const Pose& pose, double t_s) const {
    return pose.translation_m - truth(t_s).translation_m;
  }
  /// Root mean squares over poses `begin` to `end` of places, before and after; m.
  std::pair<double, double> spread(int begin, int end) const {
    double raw = 0, smooth = 0;
    for (int i = begin; i < end; ++i) {
      const double t_s = i * kStep_s;
      raw += shift(poses_[static_cast<std::size_t>(i)].room_from_body, t_s).squaredNorm();
      smooth += shift(smooth_at(around(i), t_s).room_from_body, t_s).squaredNorm();
    }
    return {std::sqrt(raw / (end - begin)), std::sqrt(smooth / (end - begin))};
  }

 private:
  MeasuredPose measured(double t_s) {
    const Pose at = truth(t_s);
    const auto noise = [&](double sigma) -> Vector3d {
      return noise_ * sigma * Vector3d(normal_(random_), normal_(random_), normal_(random_));
    };
    const Vector3d turn = noise(kSigma_rad);
    MeasuredPose pose{t_s, at};
    if (noise_ > 0)
      pose.room_from_body.rotation =
          Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * at.rotation;
    pose.room_from_body.translation_m += noise(kSigma_m);
    pose.covariance.diagonal().head<3>().setConstant(kSigma_rad * kSigma_rad);
    pose.covariance.diagonal().tail<3>().setConstant(kSigma_m * kSigma_m);
    return pose;
  }
  std::function<double(double)> way_;
  const double noise_;
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
  std::vector<MeasuredPose> poses_;
};

TEST(SmoothPoses, AConstantAccelerationIsKeptExactlyAtAnyTime) {
  const Motion motion([](double t) { return 0.1 + 0.3 * t - 0.06 * t * t; }, 0);
  for (const double t_s : {1.7, 2.0, 2.04, 2.26, 2.35}) {
    const Pose pose = smooth_at(motion.around(20), t_s).room_from_body;
    EXPECT_LT(motion.shift(pose, t_s).norm(), 1e-9) << t_s;
    EXPECT_LT(pose.rotation.angularDistance(motion.truth(t_s).rotation), 1e-7) << t_s;
  }
}

TEST(SmoothPoses, ASteadyMotionIsSmoothed) {
  const Motion motion([](double t) { return 0.4 * t; });
  const auto [raw, smooth] = motion.spread(5, 36);
  EXPECT_LT(smooth, 0.7 * raw);  // a parabola of seven poses: 0.58
  EXPECT_GT(smooth, 0.4 * raw);
}

TEST(SmoothPoses, AStepOfTheVelocityHasNoLag) {
  constexpr double kJolt_s = 2;
  // The motion jumps from rest to 0.5 m/s and 29 deg/s at once.
  const auto way = [](double t) { return t < kJolt_s ? 0 : 0.5 * (t - kJolt_s); };
  const Motion motion(way);
  const auto [raw, smooth] = motion.spread(kReach, 41 - kReach);
  EXPECT_LT(smooth, raw);
  for (int i = 16; i < 26; ++i) {
    const Pose pose = smooth_at(motion.around(i), i * kStep_s).room_from_body;
    EXPECT_LT(motion.shift(pose, i * kStep_s).norm(), 4 * kSigma_m) << i;
    EXPECT_LT(pose.rotation.angularDistance(motion.truth(i * kStep_s).rotation), 5 * kSigma_rad);
  }
  // Between two poses the step itself cannot be seen.
  for (const double t_s : {1.95, 2.05}) {
    const MeasuredPose pose = smooth_at(motion.around(20), t_s);
    const double off_m = motion.shift(pose.room_from_body, t_s).norm();
    EXPECT_LT(off_m, 0.006) << t_s;
    EXPECT_LT(off_m, 3 * std::sqrt(pose.covariance.diagonal().tail<3>().sum())) << t_s;
  }
}

TEST(SmoothPoses, APoseCountsByItsVariance) {
  const Motion motion([](double) { return 0.2; }, 0);
  const auto poses = motion.around(20);
  std::vector<MeasuredPose> around(poses.begin(), poses.end());
  around[kReach].room_from_body.translation_m.x() += 0.02;
  around[kReach].covariance *= 1600;
  EXPECT_LT(std::abs(motion.shift(smooth_at(around, 2).room_from_body, 2).x()), 2e-4);
}

TEST(SmoothPoses, FewPosesAndTimesBeyondThemAreLessCertain) {
  const Motion motion([](double t) { return 0.4 * t; }, 0);
  const auto around = motion.around(20);
  const auto variance = [&](std::size_t poses, double t_s) {
    return smooth_at(around.first(poses), t_s).covariance(3, 3);
  };
  EXPECT_GE(variance(7, 2), kSigma_m * kSigma_m) << "what poses have in common stays";
  EXPECT_LT(variance(7, 2.3), variance(7, 2.4));
  EXPECT_EQ(smooth_at(around.first(1), 1.8).room_from_body.translation_m,
            around[0].room_from_body.translation_m);
  EXPECT_LT(motion.shift(smooth_at(around.first(2), 2).room_from_body, 2).norm(), 1e-9);
}

TEST(SmoothPoses, DoesNotAllocate) {
  const Motion motion([](double t) { return std::sin(t); });
  std::vector<MeasuredPose> most;
  for (std::size_t i = 0; i < kMostSmoothed; ++i)
    most.push_back({kStep_s * static_cast<double>(i),
                    motion.truth(kStep_s * static_cast<double>(i)),
                    capture::PoseCovariance::Identity() * 1e-6});
  const long before = test::allocations;
  smooth_at(most, 1.5);
  EXPECT_EQ(test::allocations, before);
}

}  // namespace
}  // namespace mixrig::pose
