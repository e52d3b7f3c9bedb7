// SPDX-License-Identifier: Apache-2.0
// Asks a RealSense D400 camera for its factory calibration.
#pragma once

#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "hal/device/depth_camera.h"

namespace mixrig::device {

/// Of depth pictures of that size, from the node that sends them; it may be open elsewhere. Errors:
/// kDevice where the node has no such extension unit; parse_realsense_calibration.
Result<DeviceIntrinsics> realsense_intrinsics(const std::string& node, Size size);

}  // namespace mixrig::device
