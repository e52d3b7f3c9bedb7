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
/// With request.hardware_trigger every rising edge of request.trigger_input (Line0 where it is
/// empty) gives a frame.
/// Errors: kNotFound, kUnsupported (format, size), kDevice.
Result<std::unique_ptr<Camera>> open_aravis(const std::string& id, const StreamRequest& request,
                                            Clock& clock);

/// A GenICam ToF camera: the C of Coord3D_C16, ABC16, ABCY16, C32f or ABC32f, with scale, offset,
/// invalid value and intrinsics as the camera reports them (SFNC 2.7, chapter 3D Scan Control).
/// Floats become steps of kFloatDepthStep_m. Where the camera selects components it is set to send
/// Range and, in multi-part buffers, Intensity and Confidence too; they are the amplitude and the
/// confidence of a frame, as is the Y of ABCY16 its amplitude.
/// Errors also: kUnsupported for disparities and for a unit or scale that cannot be used.
Result<std::unique_ptr<DepthCamera>> open_aravis_depth(const std::string& id,
                                                       const StreamRequest& request, Clock& clock);

/// Ids of the cameras that answer. Broadcasts.
std::vector<std::string> list_aravis();

}  // namespace mixrig::device
