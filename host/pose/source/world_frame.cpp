// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/world_frame.h"

namespace mixrig::session {

geometry::Pose world_from_camera_on_floor(const geometry::Plane& floor) {
  const Eigen::Vector3d& up = floor.normal;
  const auto along_floor = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return v - up * up.dot(v);
  };
  Eigen::Vector3d ahead = along_floor(Eigen::Vector3d::UnitZ());
  if (ahead.norm() < 1e-6) ahead = along_floor(-Eigen::Vector3d::UnitY());
  ahead.normalize();
  Eigen::Matrix3d world_from_camera;
  world_from_camera.row(0) = ahead.cross(up);
  world_from_camera.row(1) = ahead;
  world_from_camera.row(2) = up;
  return {Eigen::Quaterniond(world_from_camera).normalized(),
          Eigen::Vector3d(0, 0, floor.offset_m)};
}

}  // namespace mixrig::session
