// SPDX-License-Identifier: Apache-2.0
// Finds the connected devices and makes a rig.toml of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host/capture/live/rig/device_kind.h"
#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {

struct DiscoverOptions {
  bool network = true;  ///< GigE Vision: broadcasts on every interface
};

/// Finds V4L2 nodes that stream, GenICam cameras, cameras of `kinds`, ToF cameras of the open
/// protocol, and, by a query on each serial port, a trigger board and a pan-tilt unit. Never fails;
/// a device that does not answer is not in the rig.
RigConfig discover(const DiscoverOptions& options, std::span<const DeviceKind> kinds, Clock& clock);

/// Makes a rig of the cameras in their order: the first one that sends colour is the target camera,
/// the first two that send depth are depth cameras. If there is a processed camera, V4L2 nodes that
/// are no USB devices are left out. `left_out` gets the URIs of cameras that were left out. Pure.
RigConfig rig_of(const std::vector<FoundCamera>& cameras, std::vector<std::string>& left_out);

}  // namespace mixrig::live
