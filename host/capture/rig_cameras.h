// SPDX-License-Identifier: Apache-2.0
// The cameras of a rig, as a source describes them.
#pragma once

#include <optional>

#include "host/geometry/camera_model.h"
#include "host/geometry/depth_noise.h"
#include "host/geometry/pose.h"

namespace mixrig::capture {

/// What a depth value means: along the optical axis, or along the ray.
enum class DepthKind { kZ, kDistance };

/// Intrinsics of colour and depth camera, and the pose between them.
struct RigCameras {
  geometry::CameraModel target, tof;
  std::optional<geometry::Pinhole> view;  ///< ideal view of truth and compositing, where given
  geometry::Pose target_from_tof;
  DepthKind depth_kind = DepthKind::kZ;
  geometry::DepthNoise noise;
};

}  // namespace mixrig::capture
