// SPDX-License-Identifier: Apache-2.0
// Opens a USB device in DFU mode through libusb.
#pragma once

#include <memory>
#include <string>

#include "hal/device/usb_control.h"

namespace mixrig::device {

/// Opens the device `id`, "VID:PID" in hex, and selects the alternate setting of the internal
/// flash. Errors: kUsage, kNotFound, kIo (permissions), kDevice (no DfuSe interface; two such
/// devices).
Result<std::unique_ptr<UsbControl>> open_dfu_device(const std::string& id);

}  // namespace mixrig::device
