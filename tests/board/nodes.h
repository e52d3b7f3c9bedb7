// SPDX-License-Identifier: Apache-2.0
// Device files that appear when something is plugged in.
#pragma once

#include <string>
#include <vector>

#include "tests/board/uvc_device.h"
#include "tests/board/vhci_port.h"

namespace mixrig::board {

/// Plugs a camera in, once what was on the port before is gone, and waits for its node. Empty, and
/// a failure noted, when it did not appear.
std::string plug_camera(VhciPort& port, const UsbDevice& device);
/// It is there and delivers pictures.
bool has_node(const std::string& path);

/// Plugs a serial line in, once what was at `node` before is gone, and waits for it.
bool plug_serial(VhciPort& port, const std::string& node);

/// A USB device of this product name is there.
bool has_usb(const std::string& product);

/// A camera on the bench. `node` is where it appeared.
struct UvcBench {
  UvcDevice device{{320, 180}};
  VhciPort port{0, device};
  std::string node;
  /// False, and a failure noted, when it did not appear.
  bool plug();
};

}  // namespace mixrig::board
