// SPDX-License-Identifier: Apache-2.0
// A camera of the rig and its pose, from a calibration file.
#pragma once

#include <filesystem>
#include <string>

#include "hal/base/result.h"
#include "host/math/geometry/any_camera.h"
#include "host/math/geometry/pose.h"

namespace mixrig::session {

struct RigCamera {
  geometry::AnyCamera model;
  geometry::Pose camera_from_target;
};

/// Reads the camera `name`, "fisheye" or "target". Errors: those of the file; kData if it lacks the
/// camera or its pose.
Result<RigCamera> rig_camera(const std::filesystem::path& calibration, const std::string& name);

}  // namespace mixrig::session
