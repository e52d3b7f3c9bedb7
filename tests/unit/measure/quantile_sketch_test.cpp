// SPDX-License-Identifier: Apache-2.0
#include "hal/base/quantile_sketch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/percentile.h"

namespace mixrig::measure {
namespace {

constexpr double kQuantiles[] = {0.0,  0.001, 0.01, 0.1,  0.25,  0.5,
                                 0.75, 0.9,   0.95, 0.99, 0.999, 1.0};

/// Holds every quantile of the sketch against the exact one of the same samples.
void expect_close(const std::vector<float>& samples) {
  QuantileSketch sketch;
  for (const float sample : samples) ASSERT_TRUE(sketch.add(sample));
  EXPECT_EQ(sketch.count(), samples.size());
  EXPECT_EQ(sketch.min(), *std::min_element(samples.begin(), samples.end()));
  EXPECT_EQ(sketch.max(), *std::max_element(samples.begin(), samples.end()));
  EXPECT_EQ(sketch.mean(), mean(samples));
  for (const double q : kQuantiles) {
    const double exact = quantile(samples, q);
    const double bound = exact * QuantileSketch::kRelativeError * (1.0 + 1e-9);
    EXPECT_NEAR(sketch.quantile(q), exact, bound) << "q " << q;
  }
}

TEST(QuantileSketch, OfNothingIsZero) {
  const QuantileSketch sketch;
  EXPECT_EQ(sketch.count(), 0U);
  EXPECT_EQ(sketch.mean(), 0.0);
  EXPECT_EQ(sketch.min(), 0.0);
  EXPECT_EQ(sketch.max(), 0.0);
  EXPECT_EQ(sketch.quantile(0.5), 0.0);
}

TEST(QuantileSketch, OfOneOrEqualSamplesIsExact) {
  QuantileSketch sketch;
  for (int n = 0; n < 100; ++n) {
    ASSERT_TRUE(sketch.add(7.3));
    for (const double q : kQuantiles) EXPECT_EQ(sketch.quantile(q), 7.3);
  }
  EXPECT_NEAR(sketch.mean(), 7.3, 1e-13);
}

TEST(QuantileSketch, InterpolatesByTheRankRuleOfQuantile) {
  expect_close({4, 1, 3, 2});
  expect_close({1000, 1});
  expect_close({0, 1, 1e6F});
}

TEST(QuantileSketch, HoldsItsBoundForTwoFarClusters) {
  std::mt19937 random(1);
  std::normal_distribution<float> low(2e-4F, 1e-6F);
  std::normal_distribution<float> high(5e7F, 1e4F);
  std::vector<float> samples;
  for (int n = 0; n < 10000; ++n) samples.push_back(n % 20 == 0 ? high(random) : low(random));
  expect_close(samples);
}

TEST(QuantileSketch, HoldsItsBoundForHeavyTails) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(1e-9, 1.0);
  std::vector<float> pareto;  // neither mean nor variance exists
  std::vector<float> log_uniform;
  for (int n = 0; n < 50000; ++n) {
    pareto.push_back(static_cast<float>(std::min(1.0 / uniform(random), 1e9)));
    log_uniform.push_back(static_cast<float>(std::pow(10.0, 15.0 * uniform(random) - 6.0)) * 0.99F +
                          1e-6F);
  }
  expect_close(pareto);
  expect_close(log_uniform);
}

TEST(QuantileSketch, HoldsItsBoundAtEveryBucketBorder) {
  const double gamma =
      (1.0 + QuantileSketch::kRelativeError) / (1.0 - QuantileSketch::kRelativeError);
  for (double border = QuantileSketch::kSmallest; border < QuantileSketch::kLargest;
       border *= gamma) {
    QuantileSketch sketch;
    const double sample = std::nextafter(border, 1e10);
    for (const double other : {border * 0.5, border, sample, sample * 2.0}) sketch.add(other);
    ASSERT_NEAR(sketch.quantile(1.0 / 3.0), border, border * 1.000001e-3);
    ASSERT_NEAR(sketch.quantile(2.0 / 3.0), sample, border * 1.000001e-3);
  }
}

TEST(QuantileSketch, CountsZerosExactly) {
  std::vector<float> samples(900, 0.0F);
  for (int n = 1; n <= 100; ++n) samples.push_back(static_cast<float>(n));
  expect_close(samples);
}

TEST(QuantileSketch, DoesNotDependOnTheOrderOfSamples) {
  QuantileSketch up;
  QuantileSketch down;
  for (int n = 0; n < 1000; ++n) up.add(n * 0.37);
  for (int n = 999; n >= 0; --n) down.add(n * 0.37);
  for (const double q : kQuantiles) EXPECT_EQ(up.quantile(q), down.quantile(q));
}

TEST(QuantileSketch, ReportsMinimumAndMaximumOutOfRange) {
  QuantileSketch sketch;
  for (const double sample : {2e-8, 3e-8, 1.0, 2e12, 4e12}) EXPECT_TRUE(sketch.add(sample));
  EXPECT_EQ(sketch.quantile(0.25), 2e-8);
  EXPECT_NEAR(sketch.quantile(0.5), 1.0, 1e-3);
  EXPECT_EQ(sketch.quantile(0.75), 4e12);
  EXPECT_EQ(sketch.min(), 2e-8);
  EXPECT_EQ(sketch.max(), 4e12);
}

TEST(QuantileSketch, TakesTheBoundsOfItsRange) {
  QuantileSketch sketch;
  for (int n = 0; n < 3; ++n) {
    EXPECT_TRUE(sketch.add(QuantileSketch::kSmallest));
    EXPECT_TRUE(sketch.add(QuantileSketch::kLargest));
  }
  EXPECT_NEAR(sketch.quantile(0.2), 1e-6, 1.001e-9);
  EXPECT_NEAR(sketch.quantile(0.8), 1e9, 1.001e6);
}

TEST(QuantileSketch, RefusesWhatIsNotANumberNotFiniteOrNegative) {
  QuantileSketch sketch;
  EXPECT_TRUE(sketch.add(2.0));
  EXPECT_FALSE(sketch.add(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(sketch.add(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(sketch.add(-std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(sketch.add(-1.0));
  EXPECT_EQ(sketch.count(), 1U);
  EXPECT_EQ(sketch.refused(), 4U);
  EXPECT_EQ(sketch.mean(), 2.0);
  EXPECT_EQ(sketch.quantile(1.0), 2.0);
}

TEST(QuantileSketch, ClampsTheQuantile) {
  QuantileSketch sketch;
  for (const double sample : {1.0, 2.0, 3.0}) sketch.add(sample);
  EXPECT_EQ(sketch.quantile(-0.5), 1.0);
  EXPECT_EQ(sketch.quantile(1.5), 3.0);
}

}  // namespace
}  // namespace mixrig::measure
