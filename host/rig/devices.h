// SPDX-License-Identifier: Apache-2.0
// Opens the devices of a rig by their URIs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"
#include "hal/device/pan_tilt.h"
#include "hal/device/trigger.h"
#include "host/rig/rig_config.h"

namespace mixrig::rig {

/// Errors of all: kUsage for a scheme that is not known or not built in, those of the driver.
/// Cameras: v4l2:PATH, aravis:ID.
Result<std::unique_ptr<device::Camera>> open_camera(const std::string& uri,
                                                    const device::StreamRequest& request,
                                                    Clock& clock);
/// Depth cameras: v4l2:PATH (Z16, Y16), aravis:ID (Coord3D), usb:VVVV:PPPP.
Result<std::unique_ptr<device::DepthCamera>> open_depth(const std::string& uri,
                                                        const device::StreamRequest& request,
                                                        Clock& clock);
/// Pan-tilt units: flir-ptu:PORT[@BAUD].
Result<std::unique_ptr<device::PanTilt>> open_pan_tilt(const std::string& uri, Clock& clock);
/// Triggers: mcu:PORT, gpiod:CHIP/LINES.
Result<std::unique_ptr<device::TriggerMaster>> open_trigger(const std::string& uri, Clock& clock);

/// All devices of a rig; those that it does not have are null.
struct Devices {
  std::unique_ptr<device::TriggerMaster> trigger;
  std::vector<std::unique_ptr<device::Camera>> cameras;
  std::unique_ptr<device::DepthCamera> depth;
  std::unique_ptr<device::PanTilt> pan_tilt;
};
/// Opens and sets up everything that rig.toml names; the first error ends it.
Result<Devices> open_devices(const RigConfig& rig, Clock& clock);
/// Exposure, gain, focus and white balance as rig.toml wishes. Errors: those of Camera::set.
Result<void> apply_controls(const CameraConfig& config, device::Camera& camera);

}  // namespace mixrig::rig
