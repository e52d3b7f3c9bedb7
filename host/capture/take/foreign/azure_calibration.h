// SPDX-License-Identifier: Apache-2.0
// The factory calibration that Azure Kinect and Orbbec recordings carry. Private to this module.
#pragma once

#include <string_view>

#include "hal/base/result.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"

namespace mixrig::take {

struct AzureCameras {
  geometry::CameraModel color, depth;
  geometry::Pose color_from_depth;
};

/// Parses calibration.json for pictures of these sizes, by which the camera's modes are known.
/// Pure. Errors: kFormat for a text without both cameras, kUnsupported for a size of no mode, kData
/// for values that are no camera.
Result<AzureCameras> parse_azure_calibration(std::string_view json, Size color_px, Size depth_px);

}  // namespace mixrig::take
