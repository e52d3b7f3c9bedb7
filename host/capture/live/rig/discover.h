// SPDX-License-Identifier: Apache-2.0
// Finds the connected devices and makes a rig.toml of them.
#pragma once

#include <string>
#include <vector>

#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {

struct DiscoverOptions {
  bool network = true;  ///< GigE Vision: broadcasts on every interface
};

/// Finds V4L2 nodes that stream, cameras by libcamera, GenICam cameras, OpenNI2 cameras, Kinect v2
/// by USB id, ToF cameras of the open protocol, and, by a query on each serial port, a trigger
/// board and a pan-tilt unit. Never fails; a device that does not answer is not in the rig.
RigConfig discover(const DiscoverOptions& options, Clock& clock);

/// What the libraries list, before anything is opened.
struct DeviceLists {
  std::vector<std::string> v4l2;       ///< device files
  std::vector<std::string> libcamera;  ///< ids
  std::vector<std::string> aravis;     ///< ids
  std::vector<std::string> openni2;    ///< URIs
  std::vector<std::string> kinect2;    ///< serial numbers; empty where one cannot be read
};

/// A camera that answered when it was opened, or that needs no look: then `info` has its format
/// alone.
struct FoundCamera {
  std::string uri;
  device::CameraInfo info;
};

/// URIs of what may be a camera, to be opened one after the other: without the webcams that
/// libcamera lists too, which V4L2 reads. Pure.
std::vector<std::string> uris_to_open(const DeviceLists& lists);
/// Kinects by their serial numbers, as cameras; one that may not be opened is left out beside
/// others. Pure.
std::vector<FoundCamera> kinects_of(const std::vector<std::string>& serials);
/// A rig of the cameras in their order: the first one that sends colour is the target camera, the
/// first two that send depth are depth cameras. Where libcamera delivers a camera, V4L2 nodes that
/// are no USB devices are its raw side and are left out. `left_out`: URIs of what was. Pure.
RigConfig rig_of(const std::vector<FoundCamera>& cameras, std::vector<std::string>& left_out);

}  // namespace mixrig::live
