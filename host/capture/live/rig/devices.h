// SPDX-License-Identifier: Apache-2.0
// Opens the devices of a rig by their URIs.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"
#include "hal/device/pan_tilt.h"
#include "hal/device/trigger.h"
#include "hal/device/trigger_input.h"
#include "host/capture/live/play/player.h"
#include "host/capture/live/rig/device_kind.h"
#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {

/// A recording that replaces cameras: its source, or the error of opening it.
struct Recording {
  std::string uri;  ///< "take:DIR" or the like, without the stream's name
  Result<std::unique_ptr<capture::CaptureSource>> source;
};
/// Returns the URIs of the recordings that cameras of a rig play, each once: those whose scheme is
/// "take" or one of `schemes`.
std::vector<std::string> recordings_of(const RigConfig& rig,
                                       std::span<const std::string_view> schemes = {});

/// Opens devices by URI. Errors of all methods: kUsage for an unknown scheme, kUnsupported for that
/// of an extra that is left out, those of the driver. For one thread.
class DeviceOpener {
 public:
  /// `recordings`: recordings that devices play (recordings_of). `kinds`: devices of extras.
  explicit DeviceOpener(Clock& clock, std::vector<Recording> recordings = {},
                        std::span<const DeviceKind> kinds = {});

  /// Opens a colour camera: v4l2:PATH, aravis:ID, a URI of `kinds`, or from a recording
  /// RECORDING/color (also rgb, target) and RECORDING/fisheye, such as take:DIR/color.
  Result<std::unique_ptr<device::Camera>> camera(const std::string& uri,
                                                 const device::StreamRequest& request);
  /// Opens a depth camera: v4l2:PATH (Z16, Y16), aravis:ID (Coord3D), usb:VVVV:PPPP, a URI of
  /// `kinds`, or from a recording RECORDING/depth (also tof) and RECORDING/depth2 (also tof2).
  Result<std::unique_ptr<device::DepthCamera>> depth(const std::string& uri,
                                                     const device::StreamRequest& request);
  /// Opens a head: flir-ptu:PORT[@BAUD], flir-ptu:tcp:HOST:PORT[@BAUD], RECORDING/head.
  Result<std::unique_ptr<device::PanTilt>> pan_tilt(const std::string& uri);
  /// Opens a trigger: mcu:PORT, gpiod:CHIP/LINES.
  Result<std::unique_ptr<device::TriggerMaster>> trigger(const std::string& uri);
  /// Opens a trigger input: gpiod:CHIP/LINE.
  Result<std::unique_ptr<device::TriggerInput>> edges(const std::string& uri);
  /// Returns the protocol of lens encoders for a valid URI.
  Result<LensProtocol> lens(const std::string& uri) const;
  /// Returns the connected cameras of the kinds, kind by kind.
  std::vector<FoundCamera> find();
  /// Sets when recordings that are opened from now on begin to play; without it they play as soon
  /// as possible.
  void play_at(HostTime begin) { play_at_ = begin; }
  /// Whether there are recordings at all.
  bool plays() const { return !recordings_.empty(); }
  /// The player of the first recording that was opened; its source has a calibration of its own.
  std::shared_ptr<Player> player() const { return players_.empty() ? nullptr : players_[0].second; }

 private:
  Result<std::shared_ptr<Player>> open_player(const std::string& recording);
  struct Kind {
    DeviceKind kind;
    std::unique_ptr<DeviceDriver> driver;  ///< null: no cameras, or left out of this build
  };
  const Kind* kind_of(const std::string& scheme) const;
  /// Returns the URI forms of the kinds, "URI, URI, ".
  std::string known_uris(std::string_view DeviceKind::*uri) const;
  /// Whether the scheme is that of a recording.
  bool is_recording(const std::string& scheme) const;

  Clock& clock_;
  std::vector<Recording> recordings_;
  std::optional<HostTime> play_at_;
  std::vector<std::pair<std::string, std::shared_ptr<Player>>> players_;
  std::vector<Kind> kinds_;
};

/// All devices of a rig; those that it does not have are null.
struct Devices {
  std::unique_ptr<device::TriggerMaster> trigger;
  std::unique_ptr<device::TriggerInput> edges;
  std::vector<std::unique_ptr<device::Camera>> cameras;
  std::unique_ptr<device::DepthCamera> depth, depth2;
  std::unique_ptr<device::PanTilt> pan_tilt;
  LensProtocol lens;               ///< protocol of the rig's [lens], which LensStream opens
  std::shared_ptr<Player> player;  ///< player of the recording behind the cameras, if any
};
/// Checks that the unit of depth is known. Errors: kUsage if neither the depth camera nor rig.toml
/// states it. `steps`: rig.toml's entry for that camera; null: that of the first.
Result<void> check_unit(const RigConfig& rig, const device::DepthCamera& camera,
                        const DepthConfig* steps = nullptr);
/// Opens and sets up all devices that rig.toml names; stops at the first error. A missing device is
/// kDevice, not kNotFound: it may be plugged in later, and rig.toml is not wrong. In a rig that
/// plays recordings it stays kNotFound: the recording may be missing.
Result<Devices> open_devices(const RigConfig& rig, DeviceOpener opener);
/// Sets exposure, gain, focus, white balance and zoom as given in rig.toml. Errors: those of
/// Camera::set.
Result<void> apply_controls(const CameraConfig& config, device::Camera& camera);

}  // namespace mixrig::live
