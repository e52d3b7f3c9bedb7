// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/camera_angles.h"

#include <algorithm>
#include <cmath>

namespace mixrig::stream {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// x right, y forward, z up, from x right, y down, z forward.
const Quaterniond& level_from_camera() {
  static const Quaterniond turn(std::sqrt(0.5), -std::sqrt(0.5), 0, 0);
  return turn;
}

}  // namespace

CameraAngles camera_angles(const Quaterniond& world_from_camera) {
  constexpr double kUpright = 1e-9;
  const Eigen::Matrix3d r =
      (world_from_camera.normalized() * level_from_camera().conjugate()).toRotationMatrix();
  CameraAngles angles;
  angles.tilt_rad = std::asin(std::clamp(r(2, 1), -1.0, 1.0));
  if (std::hypot(r(0, 1), r(1, 1)) < kUpright) {
    angles.pan_rad = std::atan2(r(1, 0), r(0, 0));
    return angles;
  }
  angles.pan_rad = std::atan2(-r(0, 1), r(1, 1));
  angles.roll_rad = std::atan2(-r(2, 0), r(2, 2));
  return angles;
}

Quaterniond world_from_camera(const CameraAngles& angles) {
  return AngleAxisd(angles.pan_rad, Vector3d::UnitZ()) *
         AngleAxisd(angles.tilt_rad, Vector3d::UnitX()) *
         AngleAxisd(angles.roll_rad, Vector3d::UnitY()) * level_from_camera();
}

}  // namespace mixrig::stream
