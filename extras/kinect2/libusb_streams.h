// SPDX-License-Identifier: Apache-2.0
// Bulk and isochronous pipes of a Kinect v2 through libusb.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "extras/kinect2/usb_streams.h"

namespace mixrig::device {

/// A closed device. `serial` empty: the only Kinect v2 that is connected.
/// Errors: kIo when libusb does not start. Those of open(): kNotFound; the line lists what is
/// there.
Result<std::unique_ptr<UsbStreams>> make_libusb_kinect2(const std::string& serial);
/// Serial numbers of those that are connected, by USB id; empty of one that may not be opened.
std::vector<std::string> list_kinect2();

}  // namespace mixrig::device
