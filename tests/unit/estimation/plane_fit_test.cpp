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

TEST(FitPlaneRobust, LeavesOutliersOut) {
  Points points = sheet(30, 0.001, 3);
  for (int i = 0; i < 8; ++i) points[3 * i].z() += 0.5 + 0.1 * i;
  const auto fit = fit_plane_robust(points, 0.001);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_EQ(fit.inliers.size(), 22u);
  EXPECT_NEAR(std::abs(fit.value.plane.offset_m), 2, 0.002);
}

TEST(FitPlaneRobust, RefusesALineWithoutAStatedSigma) {
  test::RandomGeometry random(4);
  Points noisy_line;
  for (int i = 0; i < 50; ++i)
    noisy_line.push_back(Vector3d(0.1 * i, 0, 0) + random.normal3(0.001));
  EXPECT_FALSE(fit_plane_robust(noisy_line).usable());
}

}  // namespace
}  // namespace mixrig::estimation
