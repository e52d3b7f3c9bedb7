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

/// Opens the camera that `arv-tool-0.8` lists as `id`. The search broadcasts on every network
/// interface.
/// With request.hardware_trigger every rising edge of request.trigger_input (Line0 if that is
/// empty) gives a frame.
/// Errors: kNotFound, kUnsupported (format, size), kDevice.
Result<std::unique_ptr<Camera>> open_aravis(const std::string& id, const StreamRequest& request,
                                            Clock& clock);

/// Opens a GenICam ToF camera. Depth is coordinate C of Coord3D_C16, ABC16, ABCY16, C32f or ABC32f,
/// with scale, offset, invalid value and intrinsics as the camera reports them (SFNC 2.7, chapter
/// 3D Scan Control). Floats become steps of kFloatDepthStep_m. A camera that selects components is
/// set to send Range and, if it has multi-part buffers, Intensity and Confidence; they become
/// amplitude and confidence of a frame. The Y of ABCY16 also becomes the amplitude.
/// Errors: those of open_aravis(); kUnsupported for disparities and for a unit or scale that cannot
/// be used.
Result<std::unique_ptr<DepthCamera>> open_aravis_depth(const std::string& id,
                                                       const StreamRequest& request, Clock& clock);

/// Returns the ids of the cameras that answer a broadcast.
std::vector<std::string> list_aravis();

}  // namespace mixrig::device
