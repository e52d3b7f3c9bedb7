// SPDX-License-Identifier: Apache-2.0
// GigE Vision and USB3 Vision cameras through libaravis: `aravis:<id>`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"

namespace mixrig::device {

/// `id` as `arv-tool-0.8` lists it. The search broadcasts on every network interface.
/// With request.hardware_trigger every rising edge of Line0 gives a frame.
/// Errors: kNotFound, kUnsupported (format, size), kDevice.
Result<std::unique_ptr<Camera>> open_aravis(const std::string& id, const StreamRequest& request,
                                            Clock& clock);

/// A GenICam ToF camera: Coord3D_C16 or the C of Coord3D_ABC16, with scale, offset, invalid value
/// and intrinsics as the camera reports them (SFNC 2.7, chapter 3D Scan Control; millimetres).
Result<std::unique_ptr<DepthCamera>> open_aravis_depth(const std::string& id,
                                                       const StreamRequest& request, Clock& clock);

/// Ids of the cameras that answer. Broadcasts.
std::vector<std::string> list_aravis();

}  // namespace mixrig::device
