// SPDX-License-Identifier: Apache-2.0
// Finds the connected devices and makes a rig.toml of them.
#pragma once

#include "host/live/rig_config.h"

namespace mixrig::live {

struct DiscoverOptions {
  bool network = true;  ///< GigE Vision: broadcasts on every interface
};

/// Finds V4L2 nodes that stream, GenICam cameras, ToF cameras of the open protocol, and, by a query
/// on each serial port, a trigger board and a pan-tilt unit. Never fails; a device that does not
/// answer is not in the rig.
RigConfig discover(const DiscoverOptions& options, Clock& clock);

}  // namespace mixrig::live
