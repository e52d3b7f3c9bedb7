// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/point_covariance.h"

namespace mixrig::pose {

Eigen::Matrix2d point_covariance(const Eigen::Vector3d& world_m,
                                 const geometry::Pose& world_from_camera,
                                 const capture::PoseCovariance& covariance,
                                 const geometry::Pinhole& view) {
  const Eigen::Matrix3d camera_from_world =
      world_from_camera.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d away = world_m - world_from_camera.translation_m;
  const Eigen::Vector3d p = camera_from_world * away;
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << view.fx_px, 0, -view.fx_px * p.x() / p.z(), 0, view.fy_px,
      -view.fy_px * p.y() / p.z();
  by_point /= p.z();
  // A turn by w and a step by d of the camera move the point by away x w - d, in world axes.
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << 0, -away.z(), away.y(), -1, 0, 0,  //
      away.z(), 0, -away.x(), 0, -1, 0,         //
      -away.y(), away.x(), 0, 0, 0, -1;
  const Eigen::Matrix<double, 2, 6> jacobian = by_point * camera_from_world * by_pose;
  return jacobian * covariance * jacobian.transpose();
}

}  // namespace mixrig::pose
