// SPDX-License-Identifier: Apache-2.0
// Factory calibration of RealSense D400 cameras, through the UVC extension unit that carries their
// hardware monitor. Layout: librealsense, src/hw-monitor.h, src/ds/d400/d400-private.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "hal/device/depth_camera.h"

namespace mixrig::device {

/// Size of a request and of an answer: they fill the control of the extension unit.
inline constexpr std::size_t kRealSenseMonitorBytes = 1024;
inline constexpr std::uint8_t kRealSenseUnit = 3, kRealSenseMonitor = 1;  ///< unit, selector
using RealSenseMessage = std::array<std::uint8_t, kRealSenseMonitorBytes>;

/// Returns the request for the table of coefficients of the rectified depth pictures.
RealSenseMessage realsense_calibration_request();
/// Reads focal length and centre of depth pictures of `size` from an answer; pixel (0, 0) is the
/// centre of the first one, there is no distortion. The focal length is that of x; that of y equals
/// it to within the rectification. Errors: kData for an answer that is short, damaged (CRC-32) or
/// to another request; kUnsupported for a size that the table does not have.
Result<DeviceIntrinsics> parse_realsense_calibration(std::span<const std::uint8_t> answer,
                                                     Size size);
/// Whether the USB ids are those of a D400 camera: one that z16_metres_per_step() knows, except the
/// L515.
bool is_realsense_d400(std::uint16_t usb_vendor, std::uint16_t usb_product);

}  // namespace mixrig::device
