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

TEST(Triangulate, MeetsExactRays) {
  const Vector3d truth(0.3, -0.2, 3.5);
  const std::vector<PointView> views = {view_of({0, 0, 0}, truth), view_of({1, 0, 0}, truth),
                                        view_of({0, 1, 0.3}, truth)};
  const auto fit = triangulate(views);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_LT((fit.value - truth).norm(), 1e-12);
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

TEST(Triangulate, LeavesAWrongViewOut) {
  const Vector3d truth(0.3, -0.2, 3.5);
  std::vector<PointView> views = {view_of({0, 0, 0}, truth), view_of({1, 0, 0}, truth),
                                  view_of({0, 1, 0.3}, truth), view_of({-1, 0, 0}, truth),
                                  view_of({1, 1, 0}, truth, {0.1, 0, 0})};
  const auto fit = triangulate(views);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_EQ(fit.inliers, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_LT((fit.value - truth).norm(), 1e-9);
}

TEST(Triangulate, RefusesWhatCannotCarryAPoint) {
  const Vector3d near(0, 0, 3), far(0, 0, 1e7);
  const auto refuses = [](std::vector<PointView> views) { return !triangulate(views).usable(); };
  EXPECT_TRUE(refuses({}));
  EXPECT_TRUE(refuses({view_of({0, 0, 0}, near)}));
  EXPECT_TRUE(refuses({view_of({0, 0, 0}, near), view_of({0, 0, 0}, near)}));
  EXPECT_TRUE(refuses({view_of({0, 0, 0}, far), view_of({0.1, 0, 0}, far)}));
  // Along the baseline both rays are one line.
  EXPECT_TRUE(refuses({view_of({0, 0, 0}, near), view_of({0, 0, 1}, near)}));
  // Rays that part meet behind the cameras.
  PointView left = view_of({-1, 0, 0}, Vector3d(-2, 0, 3)),
            right = view_of({1, 0, 0}, Vector3d(2, 0, 3));
  EXPECT_TRUE(refuses({left, right}));
  left.bearing.direction.x() = NAN;
  EXPECT_TRUE(refuses({left, right}));
}

}  // namespace
}  // namespace mixrig::estimation
