// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/plane_fit.h"

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

Points sheet(int count, double noise_m, std::uint64_t seed) {
  test::RandomGeometry random(seed);
  Points points;
  for (int i = 0; i < count; ++i)
    points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), 2 + noise_m * random.normal()});
  return points;
}

TEST(FitPlaneRobust, RecoversAnExactPlane) {
  const auto fit = fit_plane_robust(sheet(20, 0, 1));
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_NEAR(std::abs(fit.value.plane.normal.z()), 1, 1e-14);
  EXPECT_NEAR(std::abs(fit.value.plane.offset_m), 2, 1e-14);
}

TEST(FitPlaneRobust, SigmasFollowTheSpread) {
  // A strip 20 times longer than wide: the tilt across it is 20 times less certain.
  Points strip = sheet(400, 0.001, 2);
  for (auto& p : strip) p.y() *= 0.05;
  const auto fit = fit_plane_robust(strip, 0.001);
  ASSERT_EQ(fit.verdict.standing, Standing::kWeak) << fit.verdict.reason;
  EXPECT_NEAR(std::sqrt(fit.covariance(1, 1) / fit.covariance(0, 0)), 20, 1.5);
  EXPECT_NEAR(std::sqrt(fit.covariance(2, 2)), 0.001 / 20, 1e-8);
  EXPECT_NEAR(std::abs(fit.value.tangents.col(0).x()), 1, 1e-3);
}

TEST(FitPlaneRobust, LeavesOutliersOut) {
  Points points = sheet(30, 0.001, 3);
  for (int i = 0; i < 8; ++i) points[3 * i].z() += 0.5 + 0.1 * i;
  const auto fit = fit_plane_robust(points, 0.001);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_EQ(fit.inliers.size(), 22u);
  EXPECT_NEAR(std::abs(fit.value.plane.offset_m), 2, 0.002);
}

TEST(FitPlaneRobust, RefusesWhatCannotCarryAPlane) {
  test::RandomGeometry random(4);
  Points noisy_line;
  for (int i = 0; i < 50; ++i)
    noisy_line.push_back(Vector3d(0.1 * i, 0, 0) + random.normal3(0.001));
  EXPECT_FALSE(fit_plane_robust(noisy_line, 0.001).usable());
  EXPECT_FALSE(fit_plane_robust(noisy_line).usable());
  EXPECT_FALSE(fit_plane_robust(Points(9, Vector3d(1, 2, 3)), 0.001).usable());
  EXPECT_FALSE(fit_plane_robust(random.cloud(30, 1.0), 0.001).usable());
  EXPECT_FALSE(fit_plane_robust(sheet(2, 0, 1), 0.001).usable());
  Points hole = sheet(9, 0, 1);
  hole[4].x() = NAN;
  EXPECT_FALSE(fit_plane_robust(hole, 0.001).usable());
}

}  // namespace
}  // namespace mixrig::estimation
