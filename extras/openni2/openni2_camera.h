// SPDX-License-Identifier: Apache-2.0
// Depth cameras and .oni recordings through OpenNI2: `openni2:URI`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"

namespace mixrig::device {

/// An opened device; its colour and depth cameras share it and keep it alive.
class OpenNi2Device;

/// Opens a device. `uri`: as the library lists it, "any" for the first USB camera, or the path of
/// an .oni file. A file is played once from its first frame, at its own pace, as soon as all
/// cameras taken from it have started; at its end they are kStopped. An unplugged camera is
/// searched for four times a second by its URI, else by its USB id and name. Errors: kNotFound,
/// kData for a file that is not such a recording, kDevice.
Result<std::shared_ptr<OpenNi2Device>> open_openni2(const std::string& uri, Clock& clock);
/// Colour camera of a device: RGB, YUYV, grey of 8 or 16 bits. Each camera can be taken once.
/// Errors: kUnsupported (no such stream, size, rate or format), kUsage, kDevice.
Result<std::unique_ptr<Camera>> openni2_color(std::shared_ptr<OpenNi2Device> device,
                                              const StreamRequest& request);
/// Depth camera of a device: z in steps of 1 mm or 0.1 mm, not registered to the colour camera, not
/// mirrored. Focal length and centre follow from the field of view, as the library converts depth
/// to points. Each camera can be taken once. Errors: those of openni2_color().
Result<std::unique_ptr<DepthCamera>> openni2_depth(std::shared_ptr<OpenNi2Device> device,
                                                   const StreamRequest& request);
/// URIs of the USB cameras.
std::vector<std::string> list_openni2();

}  // namespace mixrig::device
