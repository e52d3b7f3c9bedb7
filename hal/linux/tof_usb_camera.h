// SPDX-License-Identifier: Apache-2.0
// ToF cameras on USB bulk transfers: `usb:VVVV:PPPP` (tof_usb_protocol.md).
#pragma once

#include <memory>
#include <string>

#include "hal/base/clock.h"
#include "hal/device/depth_camera.h"
#include "hal/device/usb_bulk.h"

namespace mixrig::device {

/// Opens a camera by `id`, "VVVV:PPPP" in hexadecimal. A pipe that stalls, or delivers nothing for
/// a second, is restarted (counted as a link error and a return). After the device was unplugged,
/// the driver looks for it four times a second. Errors: kUsage, kNotFound, kDevice.
Result<std::unique_ptr<DepthCamera>> open_tof_usb(const std::string& id, Clock& clock);
/// Opens a camera over any pipe. Errors: those of the pipe; kDevice for an invalid description.
Result<std::unique_ptr<DepthCamera>> open_tof(std::unique_ptr<UsbBulk> pipe, std::string uri,
                                              Clock& clock);

}  // namespace mixrig::device
