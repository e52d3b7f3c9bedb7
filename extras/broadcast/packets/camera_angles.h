// SPDX-License-Identifier: Apache-2.0
// A camera's rotation as pan, tilt and roll, as FreeD and OpenTrackIO have it.
#pragma once

#include <Eigen/Geometry>

namespace mixrig::stream {

/// World z up; at zero the camera looks along +y and x is to its right. Right-handed, intrinsic
/// about z, x, y: pan to the left, tilt up and, seen from behind, roll clockwise are positive.
struct CameraAngles {
  double pan_rad = 0, tilt_rad = 0, roll_rad = 0;
};

/// Angles of a camera with axes x right, y down, z forward. Roll is 0 where it looks straight up or
/// down.
CameraAngles camera_angles(const Eigen::Quaterniond& world_from_camera);
Eigen::Quaterniond world_from_camera(const CameraAngles& angles);

}  // namespace mixrig::stream
