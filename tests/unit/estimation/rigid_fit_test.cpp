// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/rigid_fit.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

Points moved(const Points& a, const geometry::Pose& b_from_a, double scale = 1) {
  Points b;
  for (const auto& p : a) b.push_back(scale * (b_from_a.rotation * p) + b_from_a.translation_m);
  return b;
}

TEST(RigidFit, RecoversAMotionExactly) {
  test::RandomGeometry random(1);
  const Points a = random.cloud(12, 1.0);
  const auto truth = random.pose(3.0);
  const auto fit = rigid_fit(a, moved(a, truth));
  ASSERT_EQ(fit.verdict.standing, Standing::kOk) << fit.verdict.reason;
  EXPECT_LT(pose_error(fit.value, truth).norm(), 1e-13);
  EXPECT_EQ(fit.inliers.size(), a.size());
}

TEST(RigidFit, StaysARotationForCoplanarPoints) {
  // Cortes Reina 2015, eq. 82, has no determinant and mirrors this set.
  const Points a = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1.3, 1, 0}};
  const geometry::Pose truth{rotation_exp({3.0, 0.4, 0.1}), {1, 2, 3}};
  const auto fit = rigid_fit(a, moved(a, truth));
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_LT(pose_error(fit.value, truth).norm(), 1e-13);
}

TEST(RigidFit, RefusesMirrorImages) {
  test::RandomGeometry random(2);
  const Points a = random.cloud(6, 0.2);
  Points b = a;
  for (auto& p : b) p.x() = -p.x();
  const auto fit = rigid_fit(a, b);
  EXPECT_FALSE(fit.usable());
  EXPECT_NE(fit.verdict.reason.find("mirror"), std::string::npos) << fit.verdict.reason;
}

TEST(RigidFit, FindsAScale) {
  test::RandomGeometry random(3);
  const Points a = random.cloud(8, 1.0);
  const auto truth = random.pose(2.0);
  const auto fit = similarity_fit(a, moved(a, truth, 0.37));
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_NEAR(fit.value.scale, 0.37, 1e-14);
  EXPECT_LT(pose_error(fit.value.pose, truth).norm(), 1e-13);
  EXPECT_EQ(fit.covariance.rows(), 7);
}

TEST(RigidFit, WeighsPoints) {
  // Two symmetric points pull the translation apart: the weights decide where it settles.
  const Points a = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  Points b = a;
  b[0].z() += 0.004, b[1].z() += 0.004;
  const std::vector<double> weights = {3, 3, 1, 1};
  const auto fit = rigid_fit(a, b, {{}, weights});
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_NEAR(fit.value.translation_m.z(), 0.003, 1e-12);
}

TEST(RigidFit, LeavesOneOutlierOut) {
  test::RandomGeometry random(4);
  const Points a = random.cloud(10, 1.0);
  const auto truth = random.pose(1.0);
  Points b = moved(a, truth);
  for (auto& p : b) p += random.normal3(1e-3);
  b[7] += Vector3d(0.2, 0, 0);
  const auto fit = rigid_fit(a, b, {1e-3, {}});
  ASSERT_EQ(fit.verdict.standing, Standing::kOk) << fit.verdict.reason;
  EXPECT_EQ(fit.inliers, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 8, 9}));
  EXPECT_GT(fit.residuals[7], 0.15);
  EXPECT_LT(pose_error(fit.value, truth).norm(), 5e-3);
}

TEST(RigidFit, RefusesWhatCannotCarryAMotion) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Points line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {4, 4, 4}}, same(5, Vector3d(1, 2, 3));
  const Points two = {{0, 0, 0}, {1, 0, 0}}, hole = {{0, 0, 0}, {1, 0, 0}, {0, nan, 0}};
  for (const Points& set : {line, same, two, hole, Points{}}) {
    EXPECT_FALSE(rigid_fit(set, set).usable());
    EXPECT_FALSE(rigid_fit(set, set, {1e-3, {}}).usable());
    EXPECT_FALSE(rigid_fit(set, set).verdict.reason.empty());
  }
  test::RandomGeometry random(5);
  const Points a = random.cloud(9, 1.0), b = random.cloud(9, 1.0);
  EXPECT_FALSE(rigid_fit(a, b).usable());
  EXPECT_FALSE(rigid_fit(a, b, {1e-3, {}}).usable());
  EXPECT_FALSE(rigid_fit(a, two).usable());
}

}  // namespace
}  // namespace mixrig::estimation
