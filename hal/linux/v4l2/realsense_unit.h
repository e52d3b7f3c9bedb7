// SPDX-License-Identifier: Apache-2.0
// Asks a RealSense D400 camera for its factory calibration.
#pragma once

#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "hal/device/depth_camera.h"

namespace mixrig::device {

/// Reads the intrinsics of depth pictures of `size` from `node`, which sends these pictures and may
/// be open elsewhere. Errors: kDevice where the node has no such extension unit; those of
/// parse_realsense_calibration().
Result<DeviceIntrinsics> realsense_intrinsics(const std::string& node, Size size);

}  // namespace mixrig::device
