// SPDX-License-Identifier: Apache-2.0
// Delays of motions and of a lamp that are made by formula.
#include "host/judge/measure/delay.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "host/judge/measure/motion.h"

namespace mixrig::measure {
namespace {

/// A pendulum of 1.9 s that loses a tenth of its swing in each, as seen at `times_s` + delay.
double pendulum(double t_s) {
  return 300 + 120 * std::exp(-0.05 * t_s) * std::sin(2 * std::numbers::pi / 1.9 * t_s);
}

struct Made {
  std::vector<Sample> truth, seen;
};

/// 25 frames a second for `seconds`; each shown `delay_s` later, give or take `jitter_s`, its value
/// scaled and off by `noise`.
Made made(double seconds, double delay_s, double jitter_s, double noise, unsigned seed,
          double (*motion)(double) = pendulum) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Made out;
  for (int i = 0; i < static_cast<int>(25 * seconds); ++i) {
    const double t_s = 1000 + i / 25.0;
    out.truth.push_back({t_s, motion(t_s - 1000)});
    out.seen.push_back({t_s + delay_s + jitter_s * normal(random),
                        0.8 * motion(t_s - 1000) - 40 + noise * normal(random)});
  }
  return out;
}

TEST(DelayOfMotion, IsFoundFarBelowAFramePeriod) {
  for (const double delay_s : {0.0134, 0.05, 0.0777, 0.25}) {
    const Made m = made(6, delay_s, 0, 0, 1);
    const auto found = delay_of_motion(m.truth, m.seen, 0.5);
    ASSERT_TRUE(found) << delay_s;
    EXPECT_NEAR(found->delay_s, delay_s, 2e-4);
    EXPECT_GT(found->correlation, 0.9999);
  }
}

TEST(DelayOfMotion, ItsUncertaintyIsThatOfManyTrials) {
  constexpr double kDelay_s = 0.061;
  double sum_2 = 0, predicted_2 = 0;
  constexpr int kTrials = 200;
  for (int seed = 1; seed <= kTrials; ++seed) {
    const Made m = made(4, kDelay_s, 0, 4, static_cast<unsigned>(seed));
    const auto found = delay_of_motion(m.truth, m.seen, 0.5);
    ASSERT_TRUE(found) << seed;
    sum_2 += (found->delay_s - kDelay_s) * (found->delay_s - kDelay_s);
    predicted_2 += found->uncertainty_s * found->uncertainty_s;
  }
  // The mean of 200 squared normal errors has a standard deviation of 10 %.
  EXPECT_NEAR(sum_2 / predicted_2, 1, 0.4);
  EXPECT_LT(std::sqrt(sum_2 / kTrials), 3e-3) << "less than a tenth of a frame period";
}

TEST(DelayOfMotion, DoesNotBelieveTheSystemsOwnTimes) {
  // A system that shows each frame one frame later than it states: stamps cannot reveal that, the
  // motion does.
  Made m = made(6, 0.05, 0, 0, 1);
  for (std::size_t i = m.seen.size() - 1; i > 0; --i) m.seen[i].value = m.seen[i - 1].value;
  const auto found = delay_of_motion(m.truth, m.seen, 0.5);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->delay_s, 0.09, 1e-3);
}

TEST(DelayOfMotion, SaysNothingWhereNothingCanBeTold) {
  const auto even = made(6, 0.05, 0, 1, 1, [](double t_s) { return 100 * t_s; });
  EXPECT_FALSE(delay_of_motion(even.truth, even.seen, 0.5)) << "an even motion has no feature";
  const auto still = made(6, 0.05, 0, 0, 1, [](double) { return 7.0; });
  EXPECT_FALSE(delay_of_motion(still.truth, still.seen, 0.5));
  const auto noise = made(6, 0.05, 0, 5000, 1);
  EXPECT_FALSE(delay_of_motion(noise.truth, noise.seen, 0.5));
  const auto brief = made(0.7, 0.05, 0, 0, 1);
  EXPECT_FALSE(delay_of_motion(brief.truth, brief.seen, 0.5));
  EXPECT_FALSE(delay_of_motion({}, {}, 0.5));
}

/// A lamp that is switched at the given times, seen by a camera with exposure `exposure_s` by 1000
/// points of time in each.
std::vector<Sample> lamp(const std::vector<double>& switches_s, double rate_hz, double exposure_s,
                         double delay_s, double seconds, double noise) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Sample> seen;
  for (int i = 0; i < static_cast<int>(rate_hz * seconds); ++i) {
    const double middle_s = i / rate_hz;
    int on = 0;
    for (int k = 0; k < 1000; ++k) {
      const double t_s = middle_s + exposure_s * ((k + 0.5) / 1000 - 0.5);
      int switched = 0;
      for (const double s : switches_s) switched += s <= t_s ? 1 : 0;
      on += switched % 2;
    }
    seen.push_back({middle_s + delay_s, 20 + 180 * on / 1000.0 + noise * normal(random)});
  }
  return seen;
}

std::vector<double> irregular_switches(double from_s, double to_s) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> pause(0.11, 0.29);
  std::vector<double> switches_s;
  for (double t_s = from_s; t_s < to_s; t_s += pause(random)) switches_s.push_back(t_s);
  return switches_s;
}

TEST(DelayOfMarker, IsKnownWithinOneExposure) {
  const auto switches_s = irregular_switches(0.3, 7.5);
  for (const double exposure_s : {0.002, 0.010, 0.030})
    for (const double delay_s : {0.018, 0.0433, 0.12}) {
      const auto seen = lamp(switches_s, 25, exposure_s, delay_s, 8, 1);
      const auto found = delay_of_marker(switches_s, seen, exposure_s, 0.3);
      ASSERT_TRUE(found) << exposure_s << ' ' << delay_s;
      EXPECT_NEAR(found->delay_s, delay_s, std::max(exposure_s, found->uncertainty_s))
          << exposure_s;
      EXPECT_LT(found->uncertainty_s, 0.01);
      EXPECT_GT(found->correlation, 0.98);
    }
}

TEST(DelayOfMarker, SaysNothingWithoutABlink) {
  const auto switches_s = irregular_switches(0.3, 7.5);
  std::vector<Sample> dark = lamp(switches_s, 25, 0.01, 0.05, 8, 1);
  for (Sample& s : dark) s.value = 20;
  EXPECT_FALSE(delay_of_marker(switches_s, dark, 0.01, 0.3));
  EXPECT_FALSE(delay_of_marker(std::vector<double>{1, 2}, dark, 0.01, 0.3));
  EXPECT_FALSE(delay_of_marker(switches_s, {}, 0.01, 0.3));
  EXPECT_FALSE(delay_of_marker(switches_s, dark, 0, 0.3));
}

TEST(ChangedColumn, IsTheMiddleOfWhatDiffers) {
  const Image<Rgb8> empty({100, 40}, {100, 100, 100});
  Image<Rgb8> picture = empty;
  for (int y = 10; y < 30; ++y)
    for (int x = 60; x < 80; ++x) picture.at(x, y) = {200, 40, 100};
  for (int x = 0; x < 50; ++x) picture.at(x, 5) = {110, 110, 110};  // noise
  EXPECT_NEAR(*changed_column(picture.view(), empty), 69, 1e-9);
  Image<std::uint8_t> left_out({100, 40}, 0);
  for (int y = 0; y < 40; ++y) std::fill_n(left_out.row(y) + 70, 30, std::uint8_t{1});
  EXPECT_NEAR(*changed_column(picture.view(), empty, left_out), 64, 1e-9);
  Image<Rgbx8> screen({100, 40}, Rgbx8{100, 100, 100, 255});
  EXPECT_FALSE(changed_column(std::as_const(screen).view(), empty)) << "nothing moves";
  screen.at(20, 20) = screen.at(20, 22) = {255, 255, 255, 0};
  EXPECT_NEAR(*changed_column(std::as_const(screen).view(), empty), 20, 1e-9);
  EXPECT_FALSE(changed_column(picture.view(), Image<Rgb8>({50, 40})));
}

}  // namespace
}  // namespace mixrig::measure
