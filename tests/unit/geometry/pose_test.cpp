// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/pose.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace mixrig::geometry {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(Pose, TakesPointsFromRightToLeft) {
  const Pose b_from_a{Eigen::Quaterniond(AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ())),
                      {1, 2, 3}};
  EXPECT_TRUE((b_from_a * Vector3d(1, 0, 0)).isApprox(Vector3d(1, 3, 3)));
  EXPECT_TRUE((inverse(b_from_a) * Vector3d(1, 3, 3)).isApprox(Vector3d(1, 0, 0)));
}

TEST(Pose, ProductsAndMatricesAgree) {
  const Pose b{Eigen::Quaterniond(0.9, 0.1, -0.3, 0.2).normalized(), {1, -2, 0.5}};
  const Pose a{Eigen::Quaterniond(0.2, -0.7, 0.3, 0.4).normalized(), {0.1, 5, -3}};
  EXPECT_LT(((b * a).matrix() - b.matrix() * a.matrix()).norm(), 1e-12);
  EXPECT_LT(((b * inverse(b)).matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
}

TEST(Pose, RefusesWhatIsNoRotation) {
  const Vector3d t(0, 0, 0);
  EXPECT_TRUE(pose_from_matrix(Matrix3d::Identity(), t));
  EXPECT_FALSE(pose_from_matrix(Matrix3d::Zero(), t));
  EXPECT_FALSE(pose_from_matrix(2.0 * Matrix3d::Identity(), t));
  EXPECT_FALSE(pose_from_matrix(Vector3d(1, 1, -1).asDiagonal().toDenseMatrix(), t));
  Matrix3d nan = Matrix3d::Identity();
  nan(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(pose_from_matrix(nan, t));
}

TEST(Pose, LookAtPutsTheTargetOnTheAxisAndUpUpwards) {
  const Pose world_from_camera = look_at({1, 1, 1.5}, {4, 5, 1.0}, Vector3d::UnitZ());
  const Pose camera_from_world = inverse(world_from_camera);
  const Vector3d target = camera_from_world * Vector3d(4, 5, 1.0);
  EXPECT_NEAR(target.x(), 0, 1e-12);
  EXPECT_NEAR(target.y(), 0, 1e-12);
  EXPECT_GT(target.z(), 0);
  EXPECT_LT((camera_from_world * Vector3d(4, 5, 2.0)).y(), 0);  // higher is up: negative y
}

}  // namespace
}  // namespace mixrig::geometry
