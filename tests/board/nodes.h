// SPDX-License-Identifier: Apache-2.0
// Device files that appear when something is plugged in.
#pragma once

#include <string>
#include <vector>

#include "tests/board/uvc_device.h"
#include "tests/board/vhci_port.h"

namespace mixrig::board {

/// Plugs a camera in, after the port's previous device has disappeared, and waits for its device
/// file. Returns its path; if it does not appear, an empty string, with a test failure.
std::string plug_camera(VhciPort& port, const UsbDevice& device);
/// Whether the device file `path` exists and delivers pictures.
bool has_node(const std::string& path);

/// Plugs a serial line in, after the previous device at `node` has disappeared, and waits for it.
bool plug_serial(VhciPort& port, const std::string& node);

/// Whether a USB device of this product name exists.
bool has_usb(const std::string& product);

/// A camera on a port; `node` is its device file.
struct UvcBench {
  UvcDevice device{{320, 180}};
  VhciPort port{0, device};
  std::string node;
  /// Returns false, with a test failure, if the camera does not appear.
  bool plug();
};

}  // namespace mixrig::board
