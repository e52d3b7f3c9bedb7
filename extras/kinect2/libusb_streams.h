// SPDX-License-Identifier: Apache-2.0
// Bulk and isochronous pipes of a Kinect v2 through libusb.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "extras/kinect2/usb_streams.h"

namespace mixrig::device {

/// Makes a closed device. `serial` empty: the only connected Kinect v2. Errors: kIo when libusb
/// does not start. open() returns kNotFound with a list of connected devices.
Result<std::unique_ptr<UsbStreams>> make_libusb_kinect2(const std::string& serial);
/// Serial numbers of connected devices, by USB id; empty for a device that may not be opened.
std::vector<std::string> list_kinect2();

}  // namespace mixrig::device
