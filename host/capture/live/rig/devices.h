// SPDX-License-Identifier: Apache-2.0
// Opens the devices of a rig by their URIs.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"
#include "hal/device/pan_tilt.h"
#include "hal/device/trigger.h"
#include "hal/device/trigger_input.h"
#include "host/capture/live/play/player.h"
#include "host/capture/live/rig/rig_config.h"

namespace mixrig::device {
class Kinect2;
class OpenNi2Device;
}  // namespace mixrig::device

namespace mixrig::live {

/// A recording that replaces cameras: its source, or the error of opening it.
struct Recording {
  std::string uri;  ///< "take:DIR" or "studio:OPTIONS", without the stream's name
  Result<std::unique_ptr<capture::CaptureSource>> source;
};
/// URIs of the recordings that cameras of a rig play, each once.
std::vector<std::string> recordings_of(const RigConfig& rig);

/// Opens devices by URI. Errors of all methods: kUsage for a scheme that is not known or not built
/// in, those of the driver. One thread.
class DeviceOpener {
 public:
  /// `recordings`: those that take: and studio: devices play (recordings_of).
  explicit DeviceOpener(Clock& clock, std::vector<Recording> recordings = {})
      : clock_(clock), recordings_(std::move(recordings)) {}

  /// v4l2:PATH, libcamera:ID, aravis:ID, openni2:URI, kinect2:SERIAL/color, take:DIR/color,
  /// take:DIR/fisheye, studio:[OPTIONS/]target, studio:OPTIONS/fisheye.
  Result<std::unique_ptr<device::Camera>> camera(const std::string& uri,
                                                 const device::StreamRequest& request);
  /// v4l2:PATH (Z16, Y16), aravis:ID (Coord3D), openni2:URI, usb:VVVV:PPPP, kinect2:SERIAL,
  /// take:DIR/depth, take:DIR/depth2, studio:[OPTIONS/]tof, studio:OPTIONS/tof2.
  Result<std::unique_ptr<device::DepthCamera>> depth(const std::string& uri,
                                                     const device::StreamRequest& request);
  /// flir-ptu:PORT[@BAUD], flir-ptu:tcp:HOST:PORT[@BAUD], take:DIR/head, studio:[OPTIONS/]head.
  Result<std::unique_ptr<device::PanTilt>> pan_tilt(const std::string& uri);
  /// mcu:PORT, gpiod:CHIP/LINES.
  Result<std::unique_ptr<device::TriggerMaster>> trigger(const std::string& uri);
  /// gpiod:CHIP/LINE.
  Result<std::unique_ptr<device::TriggerInput>> edges(const std::string& uri);
  /// When recordings that are opened from now on begin to play; as soon as possible if never
  /// called.
  void play_at(HostTime begin) { play_at_ = begin; }
  /// The player of the first recording that was opened; its source has a calibration of its own.
  std::shared_ptr<Player> player() const { return players_.empty() ? nullptr : players_[0].second; }

 private:
  Result<std::shared_ptr<Player>> open_player(const std::string& recording);
  Result<std::shared_ptr<device::OpenNi2Device>> open_openni2(const std::string& uri);
  /// The same device for its two cameras.
  Result<std::shared_ptr<device::Kinect2>> open_kinect(const std::string& serial);

  Clock& clock_;
  std::vector<Recording> recordings_;
  std::optional<HostTime> play_at_;
  std::vector<std::pair<std::string, std::shared_ptr<Player>>> players_;
  std::vector<std::pair<std::string, std::shared_ptr<device::OpenNi2Device>>> openni2_;
  std::vector<std::pair<std::string, std::shared_ptr<device::Kinect2>>> kinects_;
};

/// All devices of a rig; those that it does not have are null.
struct Devices {
  std::unique_ptr<device::TriggerMaster> trigger;
  std::unique_ptr<device::TriggerInput> edges;
  std::vector<std::unique_ptr<device::Camera>> cameras;
  std::unique_ptr<device::DepthCamera> depth, depth2;
  std::unique_ptr<device::PanTilt> pan_tilt;
  std::shared_ptr<Player> player;  ///< of the recording behind cameras, if any
};
/// Errors: kUsage where neither the depth camera nor rig.toml tells what a step is. `steps`: of
/// that camera; nothing: of the first.
Result<void> check_unit(const RigConfig& rig, const device::DepthCamera& camera,
                        const DepthConfig* steps = nullptr);
/// Opens and sets up all devices that rig.toml names; stops at the first error. A device that is
/// not there is kDevice, not kNotFound: it may be plugged in later, rig.toml is not wrong.
Result<Devices> open_devices(const RigConfig& rig, DeviceOpener opener);
/// Exposure, gain, focus, white balance and zoom as given in rig.toml. Errors: those of
/// Camera::set.
Result<void> apply_controls(const CameraConfig& config, device::Camera& camera);

}  // namespace mixrig::live
