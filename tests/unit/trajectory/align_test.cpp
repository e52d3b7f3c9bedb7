// SPDX-License-Identifier: Apache-2.0
#include "host/pose/trajectory/align.h"

#include <cmath>
#include <cstdio>
#include <functional>

#include <gtest/gtest.h>

#include "studio/stage/layout.h"
#include "tests/support/random_geometry.h"

namespace mixrig::trajectory {
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
Trajectory record(const Recording& r, const std::function<Pose(double)>& rig,
                  const Pose& rig_from_body, double clock_s, double scale = 1) {
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

/// Sum of squares of the cubic's weights at `phase` between two samples: what interpolation leaves
/// of their noise.
double left_by_cubic(double phase) {
  constexpr double kNodes[] = {-1, 0, 1, 2};
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    double weight = 1;
    for (int j = 0; j < 4; ++j)
      if (i != j) weight *= (phase - kNodes[j]) / (kNodes[i] - kNodes[j]);
    sum += weight * weight;
  }
  return sum;
}

/// Means over the pairs of relative rotations of one alignment at 25 : 10 Hz.
struct PaperFigures {
  double rotation_deg = 0;  ///< of the relative rotation
  double angle_deg = 0;     ///< of its angle, the measure of Frahm et al. 2005, section 5.1
  double offset_error_s = 0;
  double offset_sigma_s = 0;  ///< as claimed
  std::size_t pairs = 0;
};

PaperFigures figures_at(double noise_deg, std::uint64_t seed,
                        const std::function<Pose(double)>& rig) {
  const auto a = record({25, 0, 50.6, noise_deg * kDegree, 0.001, seed}, rig, kA, kOffset_s);
  const auto b = record({10, 0.013, 50.6, noise_deg * kDegree, 0.001, seed + 100}, rig, kB, 0);
  const auto fit = align(a, b);
  PaperFigures f;
  if (!fit.usable()) return f;
  f.offset_error_s = std::abs(fit.value.time_offset_s - kOffset_s);
  f.offset_sigma_s = fit.value.time_offset_sigma_s;
  for (const auto& r : fit.value.residuals) f.rotation_deg += r.angle_rad / kDegree;
  f.pairs = fit.value.residuals.size();
  f.rotation_deg /= static_cast<double>(f.pairs);
  std::size_t compared = 0;
  for (std::size_t i = 0; i + 5 < b.samples().size(); ++i) {
    const double from = b.samples()[i].t_s, to = b.samples()[i + 5].t_s;
    const auto a0 = a.at(from + fit.value.time_offset_s), a1 = a.at(to + fit.value.time_offset_s);
    if (!a0 || !a1) continue;
    const double angle_a = a0->rotation.angularDistance(a1->rotation);
    const double angle_b = b.at(from)->rotation.angularDistance(b.at(to)->rotation);
    f.angle_deg += std::abs(angle_a - angle_b) / kDegree;
    ++compared;
  }
  f.angle_deg /= static_cast<double>(compared);
  return f;
}

/// Holds the errors at growing tracker noise to what the noise alone leaves, whatever is fitted: a
/// relative rotation has the noise of two poses of either tracker, 2 + s1 + s2 variances, s for
/// what the cubic leaves of A's; three coordinates of it have the mean length sqrt(8 / pi), the
/// angle sqrt(2 / pi).
void compare_with_bound(const char* name, std::initializer_list<double> noises_deg,
                        const std::function<Pose(double, std::uint64_t)>& rig) {
  // B's samples fall on these two phases of A's steps in turn, as do the two ends of a window.
  const double spread = std::sqrt(2 + left_by_cubic(0.013 / 0.04) + left_by_cubic(0.033 / 0.04));
  const double rotation_gain = std::sqrt(8 / M_PI) * spread;
  const double angle_gain = std::sqrt(2 / M_PI) * spread;
  std::printf(
      "%s\nnoise deg  pairs  rotation deg  / bound  angle deg  / bound  offset ms  "
      "sigma\n",
      name);
  for (const double noise_deg : noises_deg) {
    constexpr int kSeeds = 3;
    PaperFigures mean;
    for (std::uint64_t seed = 3; seed < 3 + kSeeds; ++seed) {
      const PaperFigures f = figures_at(noise_deg, seed, [&](double t) { return rig(t, seed); });
      mean.pairs += f.pairs / kSeeds;
      mean.rotation_deg += f.rotation_deg / kSeeds;
      mean.angle_deg += f.angle_deg / kSeeds;
      mean.offset_error_s = std::max(mean.offset_error_s, f.offset_error_s);
      mean.offset_sigma_s = std::max(mean.offset_sigma_s, f.offset_sigma_s);
    }
    const double rotation = mean.rotation_deg / (noise_deg * rotation_gain);
    const double angle = mean.angle_deg / (noise_deg * angle_gain);
    std::printf("%9.3f  %5zu  %12.4f  %7.3f  %9.4f  %7.3f  %9.3f  %5.3f\n", noise_deg, mean.pairs,
                mean.rotation_deg, rotation, mean.angle_deg, angle, 1e3 * mean.offset_error_s,
                1e3 * mean.offset_sigma_s);
    EXPECT_GE(mean.pairs, 495u);
    EXPECT_NEAR(rotation, 1, 0.08) << noise_deg;
    EXPECT_NEAR(angle, 1, 0.08) << noise_deg;
    EXPECT_LT(mean.offset_error_s, 4 * mean.offset_sigma_s) << noise_deg;
    if (noise_deg <= 0.015) {
      EXPECT_LT(mean.offset_error_s, 0.001) << noise_deg;
      EXPECT_LT(mean.angle_deg, 0.025) << "Frahm et al. 2005, section 5.1";
    }
  }
}

TEST(Align, LeavesNoMoreErrorThanTheTrackersNoise) {
  compare_with_bound("hand-held sways", {0.004, 0.008, 0.015, 0.025, 0.05, 0.1},
                     [](double t, std::uint64_t) { return hand_held(t); });
}

TEST(Align, LeavesNoMoreErrorThanTheTrackersNoiseInTheStudio) {
  studio::StudioOptions options;
  options.scenario = studio::Scenario::kHandheld;
  const auto layout = studio::make_layout(options);
  compare_with_bound("studio, handheld", {0.004, 0.008, 0.015, 0.025},
                     [&](double t, std::uint64_t seed) {
                       options.seed = static_cast<unsigned>(seed);
                       return studio::camera_at(layout, options, t).world_from_target;
                     });
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

TEST(Align, TakesTheRotationAboutASingleAxisFromTheEpipoles) {
  const auto one_axis = [](double t) {
    const Vector3d place(0.8 * std::sin(0.7 * t), 0.5 * std::sin(1.1 * t + 0.4),
                         0.3 * std::sin(0.5 * t + 1.3));
    // Three rates without a common half period, after which a turn the other way would fit as well.
    const double turn = 0.5 * std::sin(0.83 * t) + 0.15 * std::sin(2.17 * t + 0.7);
    return Pose{rotation_exp({0, 0, turn + 0.1 * std::sin(3.71 * t)}), place};
  };
  for (const double scale : {1.0, 2.5}) {
    const auto a = record({25, 0, 50, 1e-3, 0.001, 1}, one_axis, kA, kOffset_s, scale);
    const auto b = record({10, 0, 50, 1e-3, 0.001, 2}, one_axis, kB, 0);
    for (const bool swapped : {false, true}) {
      const auto fit = swapped ? align(b, a) : align(a, b);
      ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
      EXPECT_NEAR(fit.value.time_offset_s, swapped ? -kOffset_s : kOffset_s, 0.005);
      const auto truth = swapped ? kB.rotation.conjugate() : kB.rotation;
      const double off_rad = fit.value.a_from_b.angularDistance(truth);
      EXPECT_LT(off_rad, 0.5 * kDegree);
      EXPECT_LT(off_rad, 5 * fit.value.rotation_sigma_rad);
      EXPECT_FALSE(fit.value.lever_and_scale.usable())
          << "the lever along the axis is not observable";
    }
  }
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
}  // namespace mixrig::trajectory
