// SPDX-License-Identifier: Apache-2.0
// Cameras of a rig and their poses.
#pragma once

#include <optional>

#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/depth_noise.h"
#include "host/math/geometry/pose.h"

namespace mixrig::capture {

/// Direction of a depth value: along the optical axis, or along the ray.
enum class DepthKind { kZ, kDistance };

/// A second depth camera of a rig, on another side of the colour camera.
struct SecondDepthCamera {
  geometry::CameraModel model;
  geometry::Pose target_from_tof;
  DepthKind kind = DepthKind::kZ;
  geometry::DepthNoise noise;
  double unit_m = 0.001, offset_m = 0;  ///< of 16-bit depth; captures contain the offset
  int unknown = 0;                      ///< step without a value
  bool amplitude_is_light = false;      ///< see SourceInfo::amplitude_is_light
};

/// Intrinsics of colour and depth cameras, and the poses between them.
struct RigCameras {
  geometry::CameraModel target, tof;
  std::optional<geometry::Pinhole> view;  ///< ideal view of truth and compositing, where given
  geometry::Pose target_from_tof;
  DepthKind depth_kind = DepthKind::kZ;
  geometry::DepthNoise noise;
  std::optional<SecondDepthCamera> tof2;  ///< `tof` is the first one
};

}  // namespace mixrig::capture
