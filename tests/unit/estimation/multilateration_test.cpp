// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/multilateration.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// Cortes Reina 2015, table 4: calibration constellation (mocap) and its distances to the ToF
/// sensor.
const Points kTable4_m = {{-0.5621, 0.8845, 0.1361},  {-0.2766, 0.8795, -0.1999},
                          {-0.1235, 0.8763, -0.1048}, {-0.4262, 0.8293, -0.5435},
                          {-0.7955, 0.9407, -0.4388}, {-0.7856, 0.8576, -0.3155}};
const std::vector<double> kTable4Ranges_m = {1.2854, 1.0100, 0.8657, 1.1902, 1.4735, 1.4833};

double rms_m(const Vector3d& x) {
  double sum = 0;
  for (std::size_t i = 0; i < kTable4_m.size(); ++i)
    sum += std::pow((x - kTable4_m[i]).norm() - kTable4Ranges_m[i], 2);
  return std::sqrt(sum / 6);
}

TEST(Table4, LinearSolutionWithTheSixthSphereIsThePublishedOne) {
  const auto x = multilaterate_linear(kTable4_m, kTable4Ranges_m, 5);
  ASSERT_TRUE(x);
  EXPECT_NEAR(x->x(), 0.6247, 5e-5);
  EXPECT_NEAR(x->y(), 1.4342, 5e-5);
  EXPECT_NEAR(x->z(), -0.1971, 5e-5);
  EXPECT_NEAR(rms_m(*x), 0.0594, 5e-5);
}

TEST(Table4, GeometricSolutionFitsSixTimesBetterAndNamesTheHeight) {
  // The camera stands above the constellation: its own markers are at y = 1.2 to 1.4 m.
  const auto fit = multilaterate(kTable4_m, kTable4Ranges_m, {{}, Vector3d(0.6, 1.3, -0.2)});
  ASSERT_EQ(fit.verdict.standing, Standing::kWeak) << fit.verdict.reason;
  EXPECT_NEAR(fit.value.x(), 0.6010, 5e-5);
  EXPECT_NEAR(fit.value.y(), 1.3467, 5e-5);
  EXPECT_NEAR(fit.value.z(), -0.1958, 5e-5);
  EXPECT_NEAR(rms_m(fit.value), 0.0095, 5e-5);
  // Weak: upwards (y), by six centimetres; the published height is 1.5 of these sigmas off.
  EXPECT_GT(std::abs(fit.verdict.direction.y()), 0.85);
  EXPECT_NEAR(fit.verdict.sigma, 0.0582, 5e-4);
}

// The best point on the other side of the markers, (0.5795, 0.3664, -0.1493) by random descent, has
// a sum of squared residuals of 2.862e-3 m^2, this side's best one 0.542e-3 m^2: three sigma apart
// where a range's sigma is 16.05 mm.
TEST(Table4, NamesTheSideWithoutAHintOnlyWhereTheNoiseDecidesIt) {
  EXPECT_NEAR(6 * std::pow(rms_m({0.57945, 0.36643, -0.14929}), 2), 2.8616e-3, 1e-7);
  for (const double sigma_m : {0.010, 0.0157}) {
    const auto fit = multilaterate(kTable4_m, kTable4Ranges_m, {sigma_m, {}});
    ASSERT_TRUE(fit.usable()) << sigma_m << ": " << fit.verdict.reason;
    EXPECT_NEAR(fit.value.y(), 1.3467, 5e-5);
  }
  for (const double sigma_m : {0.0164, 0.020}) {
    const auto fit = multilaterate(kTable4_m, kTable4Ranges_m, {sigma_m, {}});
    EXPECT_FALSE(fit.usable()) << sigma_m;
    EXPECT_NE(fit.verdict.reason.find("mirrored"), std::string::npos) << fit.verdict.reason;
  }
}

TEST(Multilaterate, RecoversAPointExactly) {
  test::RandomGeometry random(1);
  const Points centres = random.cloud(6, 1.0);
  const Vector3d truth(2, -1, 0.5);
  std::vector<double> ranges;
  for (const auto& c : centres) ranges.push_back((truth - c).norm());
  const auto fit = multilaterate(centres, ranges);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_LT((fit.value - truth).norm(), 1e-12);
}

TEST(Multilaterate, UsesTheHintForCoplanarCentres) {
  const Points centres = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const Vector3d truth(0.3, 0.4, 1.2);
  std::vector<double> ranges;
  for (const auto& c : centres) ranges.push_back((truth - c).norm());
  EXPECT_FALSE(multilaterate(centres, ranges, {0.001, {}}).usable());
  const auto fit = multilaterate(centres, ranges, {0.001, Vector3d(0, 0, 2)});
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_LT((fit.value - truth).norm(), 1e-9);
}

TEST(Multilaterate, LeavesOneWrongRangeOut) {
  test::RandomGeometry random(2);
  const Points centres = random.cloud(9, 1.0);
  const Vector3d truth(0.5, 1.5, -0.5);
  std::vector<double> ranges;
  for (const auto& c : centres) ranges.push_back((truth - c).norm() + 0.002 * random.normal());
  ranges[3] += 0.3;
  const auto fit = multilaterate(centres, ranges, {0.002, {}});
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_LT((fit.value - truth).norm(), 0.02);
  EXPECT_EQ(fit.inliers.size(), 8u);
}

TEST(Multilaterate, RefusesWhatCannotCarryAPoint) {
  const Points line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {5, 0, 0}};
  const std::vector<double> r = {1, 1.2, 1.9, 2.8, 4.7};
  EXPECT_FALSE(multilaterate(line, r).usable());
  EXPECT_FALSE(multilaterate(Points(5, Vector3d::Zero()), r, {0.01, {}}).usable());
  test::RandomGeometry random(3);
  const Points centres = random.cloud(5, 1.0);
  EXPECT_FALSE(multilaterate(centres, std::vector<double>{9, 1, 7, 2, 5}, {0.01, {}}).usable());
  EXPECT_FALSE(multilaterate(centres, std::vector<double>{1, 1, NAN, 1, 1}).usable());
  EXPECT_FALSE(multilaterate(centres, std::vector<double>{1, 1, -1, 1, 1}).usable());
  EXPECT_FALSE(multilaterate(centres, std::vector<double>{1, 1}).usable());
  EXPECT_FALSE(multilaterate_linear(line, r, 0));
}

}  // namespace
}  // namespace mixrig::estimation
