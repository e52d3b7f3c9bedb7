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

/// A camera that answered when it was opened, or that need not be opened: then only the format of
/// `info` is set.
struct FoundCamera {
  std::string uri;
  device::CameraInfo info;
  /// If such a camera is found, V4L2 nodes that are no USB devices are its raw side.
  bool processed = false;
};

/// Opens the devices of one kind, and keeps devices that have several cameras open. `address` is
/// the URI after its scheme and colon. For one thread.
class DeviceDriver {
 public:
  virtual ~DeviceDriver() = default;
  /// Open a camera or depth camera. Errors: kUsage if the address is none of this kind; those of
  /// the device.
  virtual Result<std::unique_ptr<device::Camera>> camera(const std::string& address,
                                                         const device::StreamRequest& request) = 0;
  virtual Result<std::unique_ptr<device::DepthCamera>> depth(
      const std::string& address, const device::StreamRequest& request) = 0;
  /// Returns the connected cameras.
  virtual std::vector<FoundCamera> find() = 0;
};

/// One entry of the table of device kinds, which host/tools makes. With neither `make` nor `lens`
/// it belongs to an extra that is left out of this build.
struct DeviceKind {
  std::string_view scheme;      ///< "kinect2" of kinect2:SERIAL
  std::string_view extra;       ///< name of the extra
  std::string_view camera_uri;  ///< form of a camera's URI; empty: it has none
  std::string_view depth_uri;   ///< form of a depth camera's URI; empty: it has none
  std::string_view lens_uri;    ///< form of a lens encoder's URI; empty: it has none
  /// Makes the driver of the cameras; null: no cameras. `clock` outlives the driver.
  std::unique_ptr<DeviceDriver> (*make)(Clock& clock) = nullptr;
  LensProtocol lens;

  bool left_out() const { return make == nullptr && lens.open == nullptr; }
};

/// Returns a kUnsupported error: `what` needs an extra that is left out of this build; the line
/// says how to build it.
Error extra_left_out(const std::string& what, std::string_view extra);

}  // namespace mixrig::live
