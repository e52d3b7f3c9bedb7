// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/triangulation.h"

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;

constexpr double kRaySigma_rad = 1e-3;

PointView view_of(const Vector3d& eye, const Vector3d& point, const Vector3d& noise = {0, 0, 0}) {
  const auto pose = geometry::look_at(eye, Vector3d(0.1, 0.2, 3), Vector3d(0, -1, 0));
  const Vector3d seen = geometry::inverse(pose) * point;
  return {pose, bearing_of(seen.normalized() + noise, kRaySigma_rad)};
}

TEST(Triangulate, CallsASmallParallaxWeakAlongTheRay) {
  const Vector3d truth(0, 0, 4);
  const std::vector<PointView> views = {view_of({0, 0, 0}, truth), view_of({0.1, 0, 0}, truth)};
  const auto fit = triangulate(views);
  ASSERT_EQ(fit.verdict.standing, Standing::kWeak) << fit.verdict.reason;
  EXPECT_GT(std::abs(fit.verdict.direction.z()), 0.99);
  // depth^2 / baseline * sigma * sqrt(2)
  EXPECT_NEAR(fit.verdict.sigma, 16 / 0.1 * kRaySigma_rad * std::sqrt(2.0), 0.01);
}

TEST(Triangulate, RefusesNothingAndViewsAlongTheirBaseline) {
  const Vector3d near(0, 0, 3);
  EXPECT_FALSE(triangulate({}).usable());
  const std::vector<PointView> one_line = {view_of({0, 0, 0}, near), view_of({0, 0, 1}, near)};
  EXPECT_FALSE(triangulate(one_line).usable());
}

}  // namespace
}  // namespace mixrig::estimation
