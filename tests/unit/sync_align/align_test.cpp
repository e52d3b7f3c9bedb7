// SPDX-License-Identifier: Apache-2.0
#include "host/sync/align.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::sync {
namespace {

using Eigen::Vector3d;
using estimation::rotation_exp;
using estimation::Standing;
using geometry::Pose;

constexpr double kDegree = M_PI / 180;

/// A hand-held camera: slow sways that never repeat within the recording.
Pose hand_held(double t_s) {
  const Vector3d turn(0.5 * std::sin(0.9 * t_s) + 0.1 * std::sin(3.7 * t_s),
                      0.6 * std::sin(0.61 * t_s + 1) + 0.08 * std::sin(4.3 * t_s),
                      0.4 * std::sin(0.37 * t_s + 2) + 0.05 * std::sin(5.1 * t_s));
  const Vector3d place(0.8 * std::sin(0.7 * t_s), 0.5 * std::sin(1.1 * t_s + 0.4),
                       0.6 * std::sin(0.5 * t_s + 1.3));
  return {rotation_exp(turn), place};
}

struct Recording {
  double rate_hz = 25, from_s = 0, to_s = 50, noise_rad = 0, noise_m = 0;
  std::uint64_t seed = 1;
};

/// The body `rig_from_body` on the rig, on a clock that shows `clock_s` more than the rig's.
Trajectory record(const Recording& r, Pose (*rig)(double), const Pose& rig_from_body,
                  double clock_s, double scale = 1) {
  test::RandomGeometry random(r.seed);
  const Pose world{rotation_exp({0.3, 1, -0.5}), {1, 2, 3}};
  std::vector<TimedPose> samples;
  for (double t = r.from_s; t < r.to_s; t += 1 / r.rate_hz) {
    Pose pose = world * rig(t) * rig_from_body;
    pose.rotation = pose.rotation * rotation_exp(random.normal3(r.noise_rad));
    pose.translation_m = scale * pose.translation_m + random.normal3(r.noise_m);
    samples.push_back({t + clock_s, pose});
  }
  return Trajectory(std::move(samples));
}

const Pose kA{}, kB{rotation_exp({0.4, -1.1, 0.7}), {0.1, -0.05, 0.2}};
constexpr double kOffset_s = 103.2174;  // t_A = t_B + offset

estimation::Estimate<Alignment> align_noisy(double noise_rad, std::uint64_t seed) {
  const auto a = record({25, 0, 50, noise_rad, 0, seed}, hand_held, kA, kOffset_s);
  const auto b = record({10, 0.013, 50, noise_rad, 0, seed + 100}, hand_held, kB, 0);
  return align(a, b);
}

TEST(Align, FindsOffsetRotationLeverAndScaleAtUnequalRates) {
  const auto a = record({25, 0, 50, 0, 0, 1}, hand_held, kA, kOffset_s, 2.0);
  const auto b = record({10, 5.013, 45, 0, 0, 2}, hand_held, kB, 0);
  const auto fit = align(a, b);
  ASSERT_EQ(fit.verdict.standing, Standing::kOk) << fit.verdict.reason;
  EXPECT_NEAR(fit.value.time_offset_s, kOffset_s, 1e-4);
  EXPECT_LT(fit.value.a_from_b.angularDistance(kB.rotation), 0.01 * kDegree);
  const auto& lever = fit.value.lever_and_scale;
  ASSERT_TRUE(lever.usable()) << lever.verdict.reason;
  EXPECT_NEAR(lever.value.scale, 2.0, 0.002);
  EXPECT_LT((lever.value.lever_m - 2.0 * kB.translation_m).norm(), 0.005);
}

TEST(Align, MeetsThePublishedFigureUnderTrackerNoise) {
  // Paper B, section 5.1: 25 : 10 Hz, mean relative rotation error 0.025 deg over 500 pairs.
  const auto fit = align_noisy(0.008 * kDegree, 3);
  ASSERT_EQ(fit.verdict.standing, Standing::kOk) << fit.verdict.reason;
  EXPECT_NEAR(fit.value.time_offset_s, kOffset_s, 0.001);
  ASSERT_GT(fit.value.residuals.size(), 450u);
  double mean = 0;
  for (const auto& r : fit.value.residuals) mean += r.angle_rad;
  EXPECT_LT(mean / static_cast<double>(fit.value.residuals.size()), 0.025 * kDegree);
}

TEST(Align, ClaimsTheSigmaThatItHas) {
  double squared = 0;
  constexpr int kTrials = 20;
  for (int seed = 0; seed < kTrials; ++seed) {
    const auto fit = align_noisy(0.1 * kDegree, 10 + seed);
    ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
    Eigen::Vector4d error;
    error << fit.value.time_offset_s - kOffset_s,
        estimation::rotation_log(fit.value.a_from_b * kB.rotation.conjugate());
    squared += error.dot(fit.covariance.inverse() * error) / 4;
  }
  // 80 degrees of freedom: 0.71..1.33 holds 95 %; the robust sigma itself scatters by a tenth.
  EXPECT_GT(squared / kTrials, 0.5);
  EXPECT_LT(squared / kTrials, 1.7);
}

TEST(Align, IsTheSameBothWaysRound) {
  const auto a = record({25, 0, 30, 1e-3, 0, 1}, hand_held, kA, kOffset_s);
  const auto b = record({10, 0, 30, 1e-3, 0, 2}, hand_held, kB, 0);
  const auto there = align(a, b), back = align(b, a);
  ASSERT_TRUE(there.usable() && back.usable());
  EXPECT_NEAR(there.value.time_offset_s, -back.value.time_offset_s, 1e-9);
  EXPECT_LT(there.value.a_from_b.angularDistance(back.value.a_from_b.conjugate()), 1e-9);
}

TEST(Align, BearsGapsDisorderAndRepeats) {
  auto samples = record({25, 0, 50, 1e-4, 0, 1}, hand_held, kA, kOffset_s).samples();
  std::erase_if(samples, [](const TimedPose& s) {
    const double t = s.t_s - kOffset_s;
    return (t > 10 && t < 14) || (t > 30 && t < 31);
  });
  samples.push_back(samples[20]);
  std::swap(samples[50], samples[70]);
  samples[90].world_from_body.translation_m.x() = NAN;
  const auto b = record({10, 0, 50, 1e-4, 0, 2}, hand_held, kB, 0);
  const auto fit = align(Trajectory(samples), b);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_NEAR(fit.value.time_offset_s, kOffset_s, 5e-4);
  EXPECT_LT(fit.value.a_from_b.angularDistance(kB.rotation), 0.1 * kDegree);
}

TEST(Align, RefusesWhatCarriesNoAlignment) {
  const auto still = [](double) { return Pose{}; };
  const auto one_axis = [](double t) {
    return Pose{rotation_exp({0, 0, 0.5 * std::sin(0.9 * t) + 0.1 * std::sin(3.7 * t)}), {}};
  };
  const auto other = [](double t) { return hand_held(1.7 * t + 400); };
  const auto b = record({10, 0, 50, 1e-3, 0, 2}, hand_held, kB, 0);
  const auto refuses = [](const Trajectory& x, const Trajectory& y) {
    const auto fit = align(x, y);
    return !fit.usable() && !fit.verdict.reason.empty();
  };
  EXPECT_TRUE(refuses(record({25, 0, 50, 1e-5, 0, 1}, still, kA, 0),
                      record({10, 0, 50, 1e-5, 0, 2}, still, kB, 0)));
  EXPECT_TRUE(refuses(record({25, 0, 50, 1e-3, 0, 1}, one_axis, kA, 0),
                      record({10, 0, 50, 1e-3, 0, 2}, one_axis, kB, 0)));
  EXPECT_TRUE(refuses(record({25, 0, 50, 1e-3, 0, 1}, other, kA, 0), b));
  EXPECT_TRUE(refuses(record({25, 0, 1, 1e-3, 0, 1}, hand_held, kA, 0), b));
  EXPECT_TRUE(refuses(Trajectory({}), b));
}

TEST(Align, RefusesAMotionThatRepeats) {
  const auto periodic = [](double t) {
    const double w = 2 * M_PI / 4;  // every 4 s
    return Pose{
        rotation_exp({0.4 * std::sin(w * t), 0.3 * std::sin(2 * w * t + 1), 0.2 * std::cos(w * t)}),
        {}};
  };
  const auto fit = align(record({25, 0, 40, 1e-4, 0, 1}, periodic, kA, 0),
                         record({10, 0, 40, 1e-4, 0, 2}, periodic, kB, 0));
  EXPECT_FALSE(fit.usable());
}

}  // namespace
}  // namespace mixrig::sync
