// SPDX-License-Identifier: Apache-2.0
// Devices that extras open, by the scheme of their URIs (ARCHITECTURE.md, "Core and extras").
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"
#include "host/capture/live/rig/lens_receiver.h"

namespace mixrig::live {

/// A camera that answered when it was opened, or that needs no look: then `info` has its format
/// alone.
struct FoundCamera {
  std::string uri;
  device::CameraInfo info;
  /// Where such a camera is found, V4L2 nodes that are no USB devices are the raw side of it.
  bool processed = false;
};

/// Opens the devices of one kind, and keeps those that have several cameras. `address`: the URI
/// behind its scheme and colon. One thread.
class DeviceDriver {
 public:
  virtual ~DeviceDriver() = default;
  /// Errors of both: kUsage where the address is none of such a camera, those of the device.
  virtual Result<std::unique_ptr<device::Camera>> camera(const std::string& address,
                                                         const device::StreamRequest& request) = 0;
  virtual Result<std::unique_ptr<device::DepthCamera>> depth(
      const std::string& address, const device::StreamRequest& request) = 0;
  /// What is connected.
  virtual std::vector<FoundCamera> find() = 0;
};

/// One entry of the table of device kinds, which host/tools makes. With neither `make` nor `lens`
/// it is one of an extra that is left out of this build.
struct DeviceKind {
  std::string_view scheme;      ///< "kinect2" of kinect2:SERIAL
  std::string_view extra;       ///< its name
  std::string_view camera_uri;  ///< how its cameras are written; empty: it has none
  std::string_view depth_uri;   ///< the same of depth cameras
  std::string_view lens_uri;    ///< the same of encoders of a lens
  /// Null: no cameras. `clock` outlives the driver.
  std::unique_ptr<DeviceDriver> (*make)(Clock& clock) = nullptr;
  LensProtocol lens;

  bool left_out() const { return make == nullptr && lens.open == nullptr; }
};

/// kUnsupported: `what` needs an extra that is left out of this build; the line says how to build
/// it.
Error extra_left_out(const std::string& what, std::string_view extra);

}  // namespace mixrig::live
