// SPDX-License-Identifier: Apache-2.0
// Cameras by libcamera as a kind of device.
#pragma once

#include <string>
#include <vector>

#include "host/capture/live/rig/device_kind.h"

namespace mixrig::device {

/// Kind of device "libcamera:ID", opened by open_libcamera().
live::DeviceKind libcamera_kind();

/// Returns `ids` without the webcams, which the V4L2 driver serves. Pure.
std::vector<std::string> without_webcams(std::vector<std::string> ids);

}  // namespace mixrig::device
