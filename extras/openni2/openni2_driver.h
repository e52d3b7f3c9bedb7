// SPDX-License-Identifier: Apache-2.0
// Cameras by OpenNI2 as a kind of device.
#pragma once

#include "host/capture/live/rig/device_kind.h"

namespace mixrig::device {

/// Kind of device "openni2:URI", a colour and a depth camera; opened by open_openni2().
live::DeviceKind openni2_kind();

}  // namespace mixrig::device
