// SPDX-License-Identifier: Apache-2.0
// Opens the devices of a rig by their URIs.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"
#include "hal/device/pan_tilt.h"
#include "hal/device/trigger.h"
#include "hal/device/trigger_input.h"
#include "host/rig/player.h"
#include "host/rig/rig_config.h"

namespace mixrig::rig {

/// Opens devices by URI. Errors of all: kUsage for a scheme that is not known or not built in,
/// those of the driver. One thread.
class DeviceOpener {
 public:
  /// `playable` opens take: and studio: recordings; none are known where it is empty.
  explicit DeviceOpener(Clock& clock, PlayableOpener playable = {})
      : clock_(clock), open_playable_(std::move(playable)) {}

  /// v4l2:PATH, aravis:ID, take:DIR/color, studio:[WORDS/]target.
  Result<std::unique_ptr<device::Camera>> camera(const std::string& uri,
                                                 const device::StreamRequest& request);
  /// v4l2:PATH (Z16, Y16), aravis:ID (Coord3D), usb:VVVV:PPPP, take:DIR/depth, studio:[WORDS/]tof.
  Result<std::unique_ptr<device::DepthCamera>> depth(const std::string& uri,
                                                     const device::StreamRequest& request);
  /// flir-ptu:PORT[@BAUD].
  Result<std::unique_ptr<device::PanTilt>> pan_tilt(const std::string& uri);
  /// mcu:PORT, gpiod:CHIP/LINES.
  Result<std::unique_ptr<device::TriggerMaster>> trigger(const std::string& uri);
  /// gpiod:CHIP/LINE.
  Result<std::unique_ptr<device::TriggerInput>> edges(const std::string& uri);
  /// What plays, where a recording was opened: it knows its own calibration.
  std::shared_ptr<Player> player() const { return players_.empty() ? nullptr : players_[0].second; }

 private:
  Result<std::shared_ptr<Player>> open_player(const std::string& recording);

  Clock& clock_;
  PlayableOpener open_playable_;
  std::vector<std::pair<std::string, std::shared_ptr<Player>>> players_;
};

/// All devices of a rig; those that it does not have are null.
struct Devices {
  std::unique_ptr<device::TriggerMaster> trigger;
  std::unique_ptr<device::TriggerInput> edges;
  std::vector<std::unique_ptr<device::Camera>> cameras;
  std::unique_ptr<device::DepthCamera> depth;
  std::unique_ptr<device::PanTilt> pan_tilt;
  std::shared_ptr<Player> player;  ///< of the recording behind cameras, if any
};
/// Opens and sets up everything that rig.toml names; the first error ends it.
Result<Devices> open_devices(const RigConfig& rig, DeviceOpener opener);
/// Exposure, gain, focus and white balance as rig.toml wishes. Errors: those of Camera::set.
Result<void> apply_controls(const CameraConfig& config, device::Camera& camera);

}  // namespace mixrig::rig
