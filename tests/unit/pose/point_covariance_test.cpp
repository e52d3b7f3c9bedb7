// SPDX-License-Identifier: Apache-2.0
// The covariance of a pixel against sampled poses, projected here with matrices.
#include "host/pose/source/point_covariance.h"

#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace mixrig::pose {
namespace {

using capture::PoseCovariance;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSamples = 40000;
const geometry::Pinhole kCovarianceView{{1280, 1024}, 1050, 1010, 630, 500};

Vector2d projected(const Eigen::Isometry3d& world_from_camera, const Vector3d& point) {
  const Vector3d p = world_from_camera.inverse() * point;
  return {1050 * p.x() / p.z() + 630, 1010 * p.y() / p.z() + 500};
}

/// Sigmas of about 0.5 mrad and 1 mm, with correlations between all six.
PoseCovariance correlated(std::mt19937& random) {
  std::normal_distribution<double> normal;
  PoseCovariance root;
  for (int row = 0; row < 6; ++row)
    for (int i = 0; i < 6; ++i) root(row, i) = (row < 3 ? 2e-4 : 4e-4) * normal(random);
  return root * root.transpose();
}

TEST(PointCovariance, IsThatOfSampledPoses) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int place = 0; place < 4; ++place) {
    const Vector3d axis = Vector3d(normal(random), normal(random), normal(random)).normalized();
    Eigen::Isometry3d mean = Eigen::Isometry3d::Identity();
    mean.rotate(Eigen::AngleAxisd(1.0 + place, axis));
    mean.translation() = Vector3d(2, -3, 1.5);
    const Vector3d point = mean * Vector3d(0.7 - 0.5 * place, 0.2 * place, 1.2 + place);
    const PoseCovariance covariance = correlated(random);
    const Eigen::Matrix2d stated =
        point_covariance(point, {Eigen::Quaterniond(mean.rotation()), mean.translation()},
                         covariance, kCovarianceView);
    const PoseCovariance root = covariance.llt().matrixL();
    Eigen::Matrix2d sampled = Eigen::Matrix2d::Zero();
    for (int i = 0; i < kSamples; ++i) {
      Eigen::Matrix<double, 6, 1> z;
      for (double& value : z) value = normal(random);
      const Eigen::Matrix<double, 6, 1> d = root * z;
      const Vector3d w = d.head<3>();
      Eigen::Isometry3d off = Eigen::Isometry3d::Identity();
      off.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()) * mean.rotation();
      off.translation() = mean.translation() + d.tail<3>();
      const Vector2d error = projected(off, point) - projected(mean, point);
      sampled += error * error.transpose() / kSamples;
    }
    // Sampling alone leaves 0.007 of a variance.
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 2; ++k)
        EXPECT_NEAR(stated(i, k), sampled(i, k), 0.03 * std::sqrt(sampled(i, i) * sampled(k, k)))
            << place << ": " << i << "," << k;
  }
}

TEST(PointCovariance, OfOneTurnAndOneStepIsTheTriangle) {
  PoseCovariance turn = PoseCovariance::Zero();
  turn(1, 1) = 1e-6;  // 1 mrad about y, for a point straight ahead: 1050 px a radian
  const Eigen::Matrix2d turned = point_covariance({0, 0, 3}, {}, turn, kCovarianceView);
  EXPECT_NEAR(turned(0, 0), 1.05 * 1.05, 1e-9);
  EXPECT_NEAR(turned(1, 1), 0, 1e-9);
  PoseCovariance step = PoseCovariance::Zero();
  step(4, 4) = 9e-6;  // 3 mm down, at 3 m
  const Eigen::Matrix2d stepped = point_covariance({0, 0, 3}, {}, step, kCovarianceView);
  EXPECT_NEAR(stepped(0, 0), 0, 1e-9);
  EXPECT_NEAR(stepped(1, 1), 1.01 * 1.01, 1e-9);
}

}  // namespace
}  // namespace mixrig::pose
