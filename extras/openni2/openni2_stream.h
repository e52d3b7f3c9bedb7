// SPDX-License-Identifier: Apache-2.0
// One stream of an OpenNI2 device: mode, unit, field of view, copying. Private to this module.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <OniCAPI.h>

#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"

namespace mixrig::device {

/// Error kDevice with the text "URI: WHAT: reason of the library".
Error openni2_error(const std::string& uri, const std::string& what);

struct OpenNi2Mode {
  OniVideoMode mode{};
  PixelFormat format = PixelFormat::kUnknown;
  bool mirrored = false;  ///< pictures come mirrored and cannot be had otherwise
};
/// Sets a mode that fits the request, the present one if it fits, and turns mirroring off. Errors:
/// kUnsupported, with the existing modes; kDevice.
Result<OpenNi2Mode> set_up_openni2(OniStreamHandle stream, const StreamRequest& request,
                                   const std::string& uri);
/// Depth unit of the mode; intrinsics where the device reports its field of view.
DepthInfo openni2_depth_info(OniStreamHandle stream, const OniVideoMode& mode);
/// Packs the rows of a picture into `out`, mirrored back where it is mirrored. False where the
/// frame is not a whole picture of that mode.
bool copy_openni2(const OniFrame& frame, const OpenNi2Mode& mode, std::span<std::uint8_t> out);

}  // namespace mixrig::device
