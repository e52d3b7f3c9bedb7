// SPDX-License-Identifier: Apache-2.0
// Poses with automatic derivatives, for chains of them. Private to this module.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/rotation.h>

#include "host/math/estimation/verdict.h"
#include "host/math/geometry/pose.h"

namespace mixrig::estimation::detail {

template <typename T>
struct PoseT {
  Eigen::Quaternion<T> rotation;
  Eigen::Matrix<T, 3, 1> translation;

  PoseT operator*(const PoseT& right) const {
    return {rotation * right.rotation, rotation * right.translation + translation};
  }
};

template <typename T>
PoseT<T> pose_cast(const geometry::Pose& pose) {
  return {pose.rotation.cast<T>(), pose.translation_m.cast<T>()};
}

/// Returns a pose moved by x, with derivatives: exp(x[0..2]) * rotation, translation + scale_m *
/// x[3..5].
template <typename T>
PoseT<T> perturbed(const geometry::Pose& pose, const T* x, double scale_m) {
  T q[4];
  ceres::AngleAxisToQuaternion(x, q);
  const Eigen::Matrix<T, 3, 1> step(x[3], x[4], x[5]);
  return {Eigen::Quaternion<T>(q[0], q[1], q[2], q[3]) * pose.rotation.cast<T>(),
          pose.translation_m.cast<T>() + scale_m * step};
}

/// Returns a pose moved by x as perturbed() moves it, in doubles.
inline geometry::Pose moved(const geometry::Pose& pose, const Eigen::Matrix<double, 6, 1>& x,
                            double scale_m) {
  return {(rotation_exp(x.head<3>()) * pose.rotation).normalized(),
          pose.translation_m + scale_m * x.tail<3>()};
}

/// Returns pose_error() of the eye_from_target that follows from two poses in a common base,
/// against the measured `eye_from_target`.
template <typename T>
Eigen::Matrix<T, 6, 1> chain_error(const PoseT<T>& base_from_eye, const PoseT<T>& base_from_target,
                                   const geometry::Pose& eye_from_target) {
  const auto eye_from_base = base_from_eye.rotation.conjugate();
  const Eigen::Quaternion<T> turn =
      eye_from_base * base_from_target.rotation * eye_from_target.rotation.conjugate().cast<T>();
  const T q[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  Eigen::Matrix<T, 6, 1> error;
  ceres::QuaternionToAngleAxis(q, error.data());
  error.template tail<3>() =
      eye_from_base * (base_from_target.translation - base_from_eye.translation) -
      eye_from_target.translation_m.cast<T>();
  return error;
}

}  // namespace mixrig::estimation::detail
