// SPDX-License-Identifier: Apache-2.0
// Finds what is plugged in and makes a rig.toml of it.
#pragma once

#include "host/rig/rig_config.h"

namespace mixrig::rig {

struct DiscoverOptions {
  bool network = true;  ///< GigE Vision: broadcasts on every interface
};

/// V4L2 nodes that stream, GenICam cameras, ToF cameras of the open protocol, and serial ports by
/// asking who answers: a trigger board or a pan-tilt unit. Never fails; what does not answer is not
/// in the rig.
RigConfig discover(const DiscoverOptions& options, Clock& clock);

}  // namespace mixrig::rig
