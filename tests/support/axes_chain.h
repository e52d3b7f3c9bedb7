// SPDX-License-Identifier: Apache-2.0
// The pan-tilt chain of a calibration by Rodrigues' formula, for tests that check the pipeline's
// chain.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

#include "host/capture/calibration_file/calibration.h"

namespace mixrig::test {

/// Turn about an axis of a calibration by an encoder's angle.
inline Eigen::Isometry3d turn_about(const calibration_file::PanTilt::Axis& axis,
                                    double encoder_rad) {
  const double angle = axis.scale * (encoder_rad + axis.offset_rad);
  const Eigen::Vector3d& a = axis.direction;
  Eigen::Matrix3d cross;
  cross << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  const Eigen::Matrix3d turn =
      Eigen::Matrix3d::Identity() + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turn;
  pose.translation() = axis.point_m - turn * axis.point_m;
  return pose;
}

inline Eigen::Isometry3d isometry(const geometry::Pose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = pose.rotation.toRotationMatrix();
  out.translation() = pose.translation_m;
  return out;
}

/// base_from_target at encoder angles, as docs/reference/calibration_file.md defines [pan_tilt].
inline Eigen::Isometry3d base_from_target(const calibration_file::PanTilt& unit, double pan_rad,
                                          double tilt_rad) {
  return turn_about(unit.pan, pan_rad) * turn_about(unit.tilt, tilt_rad) *
         isometry(unit.head_from_target);
}

inline double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::Quaterniond(a.rotation()).angularDistance(Eigen::Quaterniond(b.rotation()));
}

}  // namespace mixrig::test
