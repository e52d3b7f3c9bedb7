// SPDX-License-Identifier: Apache-2.0
// The chain of a pan-tilt head, written here a second time from its definition (PanTilt in
// calibration.h, PanTiltChain in pan_tilt_chain.h) with matrices.
#include "host/pose/source/pan_tilt_poses.h"

#include <random>

#include <gtest/gtest.h>

#include "host/math/estimation/verdict.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/pose/swing.h"

namespace mixrig::pose {
namespace {

using calibration_file::PanTilt;
using capture::PoseCovariance;
using capture::PoseLoss;
using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

/// Rotation of points about a line: Rodrigues' formula, about a point of the line.
Matrix4d about(const Vector3d& axis, const Vector3d& point, double angle_rad) {
  Matrix3d k;
  k << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  const Matrix3d r =
      Matrix3d::Identity() + std::sin(angle_rad) * k + (1 - std::cos(angle_rad)) * k * k;
  Matrix4d m = Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = r;
  m.topRightCorner<3, 1>() = point - r * point;
  return m;
}

/// Skew, offset, scales, camera on the head: the unknowns of the calibration.
struct Unknowns {
  double skew_rad = 0.011, offset_m = 0.013, pan_scale = 1.002, tilt_scale = 0.997;
  geometry::Pose head_from_camera{
      Eigen::Quaterniond(Eigen::AngleAxisd(1.9, Vector3d(-0.9, 0.1, 0.2).normalized())),
      {0.02, 0.09, 0.06}};
};

Matrix4d base_from_camera(const Unknowns& u, double pan_rad, double tilt_rad) {
  const Vector3d tilt_axis(std::cos(u.skew_rad), 0, std::sin(u.skew_rad));
  Matrix4d offset = Matrix4d::Identity();
  offset(1, 3) = u.offset_m;
  return about(Vector3d::UnitZ(), Vector3d::Zero(), u.pan_scale * pan_rad) * offset *
         about(tilt_axis, Vector3d::Zero(), u.tilt_scale * tilt_rad) * u.head_from_camera.matrix();
}

PanTilt unit_of(const Unknowns& u) {
  PanTilt unit;
  unit.pan.scale = u.pan_scale;
  unit.tilt.direction = {std::cos(u.skew_rad), 0, std::sin(u.skew_rad)};
  unit.tilt.point_m = {0, u.offset_m, 0};
  unit.tilt.scale = u.tilt_scale;
  unit.head_from_target = u.head_from_camera;
  unit.head_from_target.translation_m.y() += u.offset_m;
  return unit;
}

double worst(const Matrix4d& a, const Matrix4d& b) { return (a - b).cwiseAbs().maxCoeff(); }

TEST(PanTiltPoses, FollowTheDefinitionOfTheCalibration) {
  PanTilt unit = unit_of({});
  unit.pan.direction = Vector3d(0.02, -0.01, 1).normalized();
  unit.pan.point_m = {0.3, -0.2, 0.7};
  unit.pan.offset_rad = 0.021;
  unit.tilt.offset_rad = -0.034;
  for (double pan_rad : {-1.2, 0.0, 0.7})
    for (double tilt_rad : {-0.5, 0.0, 0.4}) {
      const Matrix4d expected =
          about(unit.pan.direction, unit.pan.point_m, 1.002 * (pan_rad + 0.021)) *
          about(unit.tilt.direction, unit.tilt.point_m, 0.997 * (tilt_rad - 0.034)) *
          unit.head_from_target.matrix();
      EXPECT_LT(worst(base_from_target(unit, {pan_rad, tilt_rad}).matrix(), expected), 1e-12);
    }
}

TEST(PanTiltPoses, AgreeWithTheChainThatTheCalibrationSolves) {
  const Unknowns u;
  for (double pan_rad : {-0.9, 0.0, 0.4})
    for (double tilt_rad : {-0.3, 0.2})
      EXPECT_LT(worst(base_from_target(unit_of(u), {pan_rad, tilt_rad}).matrix(),
                      base_from_camera(u, pan_rad, tilt_rad)),
                1e-12);
}

TEST(PanTiltPoses, StandInTheWorldAtTheAnglesOfTheCapture) {
  const geometry::Pose world_from_base{Eigen::Quaterniond(Eigen::AngleAxisd(2, Vector3d::UnitZ())),
                                       {1, 2, 0.9}};
  const auto poses = make_pan_tilt_poses(unit_of({}), world_from_base);
  auto capture = capture_at(1);
  EXPECT_EQ(poses->pose_of(capture).loss, PoseLoss::kNoAngle);
  capture.pan_tilt = {0.3, NAN};
  EXPECT_EQ(poses->pose_of(capture).loss, PoseLoss::kNotFinite);
  capture.pan_tilt = {0.3, -0.1};
  const auto pose = poses->pose_of(capture);
  ASSERT_TRUE(pose.ok());
  EXPECT_LT(worst(pose.world_from_target.matrix(),
                  world_from_base.matrix() * base_from_camera({}, 0.3, -0.1)),
            1e-12);
  EXPECT_FALSE(pose.covariance) << "neither covariance nor repeatability is known";
  const long before = test::allocations;
  (void)poses->pose_of(capture);
  EXPECT_EQ(test::allocations, before);
}

/// Root of a covariance with correlations: sigmas of 0.3 to 1.5 mrad and mm.
Eigen::Matrix<double, 10, 10> root() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 10, 10> l;
  for (int i = 0; i < 10; ++i)
    for (int k = 0; k < 10; ++k) l(i, k) = 3e-4 * normal(random);
  return l;
}

TEST(PanTiltPoses, CovarianceIsThatOfSampledCalibrations) {
  constexpr int kSamples = 40000;
  constexpr double kAngle_rad = 4e-4, kPlace_m = 3e-4, kPan_rad = 0.6, kTilt_rad = -0.35;
  const Unknowns u;
  PanTilt unit = unit_of(u);
  unit.covariance = Eigen::MatrixXd::Zero(16, 16);
  unit.covariance.topLeftCorner<10, 10>() = root() * root().transpose();
  unit.repeatability_rad = kAngle_rad;
  unit.repeatability_m = kPlace_m;
  const auto stated = covariance_of(unit, {kPan_rad, kTilt_rad});
  ASSERT_TRUE(stated);

  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  const Matrix4d mean = base_from_camera(u, kPan_rad, kTilt_rad);
  PoseCovariance sampled = PoseCovariance::Zero();
  for (int i = 0; i < kSamples; ++i) {
    Eigen::Matrix<double, 10, 1> z;
    for (double& value : z) value = normal(random);
    const Eigen::Matrix<double, 10, 1> d = root() * z;
    Unknowns moved = u;
    moved.skew_rad += d[0], moved.offset_m += d[1];
    moved.pan_scale += d[2], moved.tilt_scale += d[3];
    const Vector3d w = d.segment<3>(4);
    moved.head_from_camera.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(w.norm(), w.normalized())) *
        u.head_from_camera.rotation;
    moved.head_from_camera.translation_m += d.tail<3>();
    const Matrix4d at =
        base_from_camera(moved, kPan_rad + kAngle_rad * normal(random) / u.pan_scale,
                         kTilt_rad + kAngle_rad * normal(random) / u.tilt_scale);
    const Matrix3d turn = at.topLeftCorner<3, 3>() * mean.topLeftCorner<3, 3>().transpose();
    Eigen::Matrix<double, 6, 1> error;
    error << 0.5 * (turn(2, 1) - turn(1, 2)), 0.5 * (turn(0, 2) - turn(2, 0)),
        0.5 * (turn(1, 0) - turn(0, 1)), at.topRightCorner<3, 1>() - mean.topRightCorner<3, 1>();
    for (int axis = 3; axis < 6; ++axis) error[axis] += kPlace_m * normal(random);
    sampled += error * error.transpose() / kSamples;
  }
  // Element by element in units of both sigmas: sampling alone leaves 1 / sqrt(40000) = 0.005.
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k)
      EXPECT_NEAR((*stated)(i, k), sampled(i, k), 0.03 * std::sqrt(sampled(i, i) * sampled(k, k)))
          << i << "," << k;
}

TEST(PanTiltPoses, CovarianceTurnsWithTheWorld) {
  PanTilt unit = unit_of({});
  unit.repeatability_rad = 1e-3;
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()));
  auto capture = capture_at(0);
  capture.pan_tilt = {0.2, 0.1};
  const auto base = make_pan_tilt_poses(unit, {})->pose_of(capture);
  const auto turned = make_pan_tilt_poses(unit, {quarter, {5, 5, 5}})->pose_of(capture);
  ASSERT_TRUE(base.covariance && turned.covariance);
  // A quarter about x: y becomes z, z becomes -y.
  EXPECT_NEAR((*turned.covariance)(2, 2), (*base.covariance)(1, 1), 1e-15);
  EXPECT_NEAR((*turned.covariance)(4, 4), (*base.covariance)(5, 5), 1e-15);
  EXPECT_NEAR((*turned.covariance)(1, 5), -(*base.covariance)(2, 4), 1e-15);
}

}  // namespace
}  // namespace mixrig::pose
