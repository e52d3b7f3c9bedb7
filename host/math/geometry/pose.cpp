// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/pose.h"

namespace mixrig::geometry {

Eigen::Matrix4d Pose::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = translation_m;
  return m;
}

Pose inverse(const Pose& b_from_a) {
  const Eigen::Quaterniond back = b_from_a.rotation.conjugate();
  return {back, -(back * b_from_a.translation_m)};
}

Result<Pose> pose_from_matrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m,
                              double tolerance) {
  if (!rotation.allFinite() || !translation_m.allFinite())
    return Error{ErrorCode::kData, "the pose holds a value that is not finite"};
  const double off =
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > tolerance || rotation.determinant() <= 0.0)
    return Error{ErrorCode::kData, "the matrix is no rotation (R^T R is off by " +
                                       std::to_string(off) + ", determinant " +
                                       std::to_string(rotation.determinant()) + ")"};
  return Pose{Eigen::Quaterniond(rotation).normalized(), translation_m};
}

Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up) {
  Eigen::Matrix3d world_from_camera;
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  world_from_camera.col(0) = right;
  world_from_camera.col(1) = forward.cross(right);
  world_from_camera.col(2) = forward;
  return {Eigen::Quaterniond(world_from_camera), eye};
}

}  // namespace mixrig::geometry
