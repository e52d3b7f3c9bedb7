// SPDX-License-Identifier: Apache-2.0
// The Kinect v2 as a kind of device.
#pragma once

#include <string>
#include <vector>

#include "host/capture/live/rig/device_kind.h"

namespace mixrig::device {

/// kinect2:SERIAL is the depth camera, kinect2:SERIAL/color the colour camera; an empty SERIAL
/// means the only one that is connected.
live::DeviceKind kinect2_kind();

/// Kinects as cameras, by their serial numbers. A Kinect that may not be opened is left out where
/// others are found. Pure.
std::vector<live::FoundCamera> kinects_of(const std::vector<std::string>& serials);

}  // namespace mixrig::device
