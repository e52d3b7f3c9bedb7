// SPDX-License-Identifier: Apache-2.0
// ToF cameras on USB bulk transfers: `usb:VVVV:PPPP` (tof_usb_protocol.md).
#pragma once

#include <memory>
#include <string>

#include "hal/base/clock.h"
#include "hal/device/depth_camera.h"

namespace mixrig::device {

/// Several transfers are in flight, so that the bus never waits for the host. A stalled pipe is
/// cleared, a device that went away is looked for four times a second.
/// `id` is "VVVV:PPPP" in hexadecimal. Errors: kUsage, kNotFound, kDevice.
Result<std::unique_ptr<DepthCamera>> open_tof_usb(const std::string& id, Clock& clock);

}  // namespace mixrig::device
