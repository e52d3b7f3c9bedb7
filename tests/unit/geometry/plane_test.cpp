// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/plane.h"

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace mixrig::geometry {
namespace {

using Eigen::Vector3d;

TEST(FitPlane, FindsAKnownPlane) {
  const Vector3d normal = Vector3d(0.1, -0.9, -0.3).normalized();
  const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Vector3d> points;
  for (int i = 0; i < 50; ++i)
    points.push_back(1.4 * normal + std::sin(i * 1.3) * u + std::cos(i * 0.7) * v);
  const auto plane = fit_plane(points);
  ASSERT_TRUE(plane);
  EXPECT_NEAR(std::abs(plane->normal.dot(normal)), 1.0, 1e-12);
  EXPECT_NEAR(std::abs(plane->offset_m), 1.4, 1e-12);
  EXPECT_NEAR(plane->signed_distance_m(points[3]), 0.0, 1e-12);
}

TEST(FitPlane, RefusesWhatCannotCarryAPlane) {
  const std::vector<Vector3d> two = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(fit_plane(two));
  const std::vector<Vector3d> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
  EXPECT_FALSE(fit_plane(line));
  const std::vector<Vector3d> same(5, Vector3d(1, 2, 3));
  EXPECT_FALSE(fit_plane(same));
  const std::vector<Vector3d> nan = {
      {0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}};
  EXPECT_FALSE(fit_plane(nan));
}

}  // namespace
}  // namespace mixrig::geometry
