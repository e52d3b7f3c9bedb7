// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/pan_tilt_poses.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/math/estimation/verdict.h"

namespace mixrig::pose {
namespace {

using calibration_file::PanTilt;
using capture::CameraPose;
using capture::PoseCovariance;
using capture::PoseLoss;
using device::PanTiltAngles;
using Eigen::Vector3d;
using geometry::Pose;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr int kChainParameters = 10;  ///< skew, offset, two scales, head_from_camera
constexpr int kCalibrated = 16;       ///< kChainParameters and the board's pose

double angle_rad(const PanTilt::Axis& axis, double encoder_rad) {
  return axis.scale * (encoder_rad + axis.offset_rad);
}

/// Returns the variance of the true angle at a reading: play, and the rounding to whole steps,
/// which is uniform.
double angle_variance(const PanTilt& unit, const PanTilt::Axis& axis) {
  const double step_rad = axis.scale * axis.step_rad;
  return unit.repeatability_rad * unit.repeatability_rad + step_rad * step_rad / 12;
}

/// Returns the turn about an axis of base, in base axes.
Pose turn(const PanTilt::Axis& axis, double encoder_rad) {
  const Eigen::Quaterniond rotation(
      Eigen::AngleAxisd(angle_rad(axis, encoder_rad), axis.direction));
  return {rotation, axis.point_m - rotation * axis.point_m};
}

/// Returns the change of (rotation vector, translation) of a pose per radian about an axis through
/// `point_m`.
Vector6d turned_by(const Vector3d& direction, const Vector3d& point_m, const Pose& pose) {
  Vector6d step;
  step << direction, direction.cross(pose.translation_m - point_m);
  return step;
}

/// The chain at some angles; the tilt axis is turned by the pan.
struct Chain {
  Pose pan, tilt, base_from_target;
  Vector3d tilt_direction, tilt_point_m;
};

Chain chain_at(const PanTilt& unit, const PanTiltAngles& encoder) {
  Chain chain{turn(unit.pan, encoder.pan_rad), turn(unit.tilt, encoder.tilt_rad), {}, {}, {}};
  chain.base_from_target = chain.pan * chain.tilt * unit.head_from_target;
  chain.tilt_direction = chain.pan.rotation * unit.tilt.direction;
  chain.tilt_point_m = chain.pan * unit.tilt.point_m;
  return chain;
}

/// Returns d(rotation vector, translation) of base_from_target by the parameters of the
/// calibration.
Eigen::Matrix<double, 6, kChainParameters> slope(const PanTilt& unit,
                                                 const PanTiltAngles& encoder) {
  const Chain chain = chain_at(unit, encoder);
  const Pose& pose = chain.base_from_target;
  const Vector6d by_pan = turned_by(unit.pan.direction, unit.pan.point_m, pose);
  const Vector6d by_tilt = turned_by(chain.tilt_direction, chain.tilt_point_m, pose);
  // The offset is along y of base (pan axis x tilt axis), the skew turns the tilt axis about -y.
  const Vector3d y = unit.pan.direction.cross(unit.tilt.direction).normalized();
  const Vector3d skewed = -(y - chain.tilt.rotation * y);
  const Pose tilted = chain.tilt * unit.head_from_target;
  Eigen::Matrix<double, 6, kChainParameters> j = Eigen::Matrix<double, 6, kChainParameters>::Zero();
  j.col(0) << chain.pan.rotation * skewed,
      chain.pan.rotation * skewed.cross(tilted.translation_m - unit.tilt.point_m);
  j.col(1).tail<3>() = chain.pan.rotation * y;
  j.col(2) = (encoder.pan_rad + unit.pan.offset_rad) * by_pan;
  j.col(3) = (encoder.tilt_rad + unit.tilt.offset_rad) * by_tilt;
  const Eigen::Matrix3d base_from_head = (chain.pan.rotation * chain.tilt.rotation).matrix();
  j.block<3, 3>(0, 4) = base_from_head;
  j.block<3, 3>(3, 7) = base_from_head;
  return j;
}

PoseCovariance turned(const PoseCovariance& covariance, const Eigen::Quaterniond& by) {
  PoseCovariance both = PoseCovariance::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = by.toRotationMatrix();
  return both * covariance * both.transpose();
}

class PanTiltPoses final : public capture::PoseSource {
 public:
  PanTiltPoses(const PanTilt& unit, const Pose& world_from_base)
      : PoseSource(
            {"pan_tilt", fmt::format("pan_tilt: the calibrated chain at the head's angles at "
                                     "mid-exposure ({} views, repeatability {:.4f} deg)",
                                     unit.views, unit.repeatability_rad * 180 / std::numbers::pi)}),
        unit_(unit),
        world_from_base_(world_from_base) {}
  CameraPose pose_of(const capture::Capture& capture) override {
    if (!capture.pan_tilt) return CameraPose::lost(PoseLoss::kNoAngle);
    const PanTiltAngles& angles = *capture.pan_tilt;
    if (!std::isfinite(angles.pan_rad) || !std::isfinite(angles.tilt_rad))
      return CameraPose::lost(PoseLoss::kNotFinite);
    CameraPose pose;
    pose.world_from_target = world_from_base_ * base_from_target(unit_, angles);
    if (const auto covariance = covariance_of(unit_, angles))
      pose.covariance = turned(*covariance, world_from_base_.rotation);
    return pose;
  }

 private:
  const PanTilt unit_;
  const Pose world_from_base_;
};

}  // namespace

Pose base_from_target(const PanTilt& unit, const PanTiltAngles& encoder) {
  return chain_at(unit, encoder).base_from_target;
}

std::optional<PoseCovariance> covariance_of(const PanTilt& unit, const PanTiltAngles& encoder) {
  const bool calibrated = unit.covariance.rows() == kCalibrated;
  const double pan_variance = angle_variance(unit, unit.pan),
               tilt_variance = angle_variance(unit, unit.tilt);
  if (!calibrated && pan_variance + tilt_variance <= 0 && unit.repeatability_m <= 0)
    return std::nullopt;
  const Chain chain = chain_at(unit, encoder);
  const Vector6d by_pan = turned_by(unit.pan.direction, unit.pan.point_m, chain.base_from_target);
  const Vector6d by_tilt =
      turned_by(chain.tilt_direction, chain.tilt_point_m, chain.base_from_target);
  PoseCovariance covariance =
      pan_variance * by_pan * by_pan.transpose() + tilt_variance * by_tilt * by_tilt.transpose();
  covariance.diagonal().tail<3>().array() += unit.repeatability_m * unit.repeatability_m;
  if (calibrated) {
    const auto j = slope(unit, encoder);
    const Eigen::Matrix<double, kChainParameters, kChainParameters> known =
        unit.covariance.topLeftCorner<kChainParameters, kChainParameters>();
    covariance += j * known * j.transpose();
  }
  return covariance;
}

std::unique_ptr<capture::PoseSource> make_pan_tilt_poses(const PanTilt& unit,
                                                         const Pose& world_from_base) {
  return std::make_unique<PanTiltPoses>(unit, world_from_base);
}

}  // namespace mixrig::pose
