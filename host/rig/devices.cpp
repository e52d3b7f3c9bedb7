// SPDX-License-Identifier: Apache-2.0
#include "host/rig/devices.h"

#include <charconv>
#include <utility>

#include "hal/linux/flir_ptu.h"
#include "hal/linux/mcu_trigger.h"
#include "hal/linux/serial_byte_stream.h"
#include "hal/linux/tof_usb_camera.h"
#include "hal/linux/v4l2_camera.h"
#ifdef MIXRIG_HAVE_ARAVIS
#include "hal/linux/aravis_camera.h"
#endif
#ifdef MIXRIG_HAVE_GPIOD
#include "hal/linux/gpiod_lines.h"
#endif

namespace mixrig::rig {
namespace {

constexpr int kPtuBaud = 9600;

struct Uri {
  std::string scheme, rest;
};

Uri split(const std::string& uri) {
  const auto colon = uri.find(':');
  if (colon == std::string::npos) return {uri, {}};
  return {uri.substr(0, colon), uri.substr(colon + 1)};
}

Error unknown(const std::string& uri, const char* what, const char* known) {
  return Error{ErrorCode::kUsage, "'" + uri + "' is no " + what + ": use " + known};
}

}  // namespace

Result<std::unique_ptr<device::Camera>> open_camera(const std::string& uri,
                                                    const device::StreamRequest& request,
                                                    Clock& clock) {
  const Uri parts = split(uri);
  if (parts.scheme == "v4l2") {
    MIXRIG_ASSIGN(auto camera, device::V4l2Camera::open(parts.rest, request, clock));
    return std::unique_ptr<device::Camera>(std::move(camera));
  }
#ifdef MIXRIG_HAVE_ARAVIS
  if (parts.scheme == "aravis") return device::open_aravis(parts.rest, request, clock);
#endif
  return unknown(uri, "camera", "v4l2:/dev/videoN or aravis:ID");
}

Result<std::unique_ptr<device::DepthCamera>> open_depth(const std::string& uri,
                                                        const device::StreamRequest& request,
                                                        Clock& clock) {
  const Uri parts = split(uri);
  if (parts.scheme == "usb") return device::open_tof_usb(parts.rest, clock);
  if (parts.scheme == "v4l2") {
    device::StreamRequest depth = request;
    if (depth.format == device::PixelFormat::kUnknown) depth.format = device::PixelFormat::kDepth16;
    MIXRIG_ASSIGN(auto camera, device::V4l2Camera::open(parts.rest, depth, clock));
    return device::as_depth_camera(std::move(camera), {});
  }
#ifdef MIXRIG_HAVE_ARAVIS
  if (parts.scheme == "aravis") return device::open_aravis_depth(parts.rest, request, clock);
#endif
  return unknown(uri, "depth camera", "usb:VVVV:PPPP, v4l2:/dev/videoN or aravis:ID");
}

Result<std::unique_ptr<device::PanTilt>> open_pan_tilt(const std::string& uri, Clock& clock) {
  const Uri parts = split(uri);
  if (parts.scheme != "flir-ptu") return unknown(uri, "pan-tilt unit", "flir-ptu:/dev/ttyUSB0");
  const auto at = parts.rest.rfind('@');
  int baud = kPtuBaud;
  if (at != std::string::npos) {
    const char* end = parts.rest.data() + parts.rest.size();
    const auto [stop, fault] = std::from_chars(parts.rest.data() + at + 1, end, baud);
    if (fault != std::errc() || stop != end || baud < 300 || baud > 4'000'000)
      return Error{ErrorCode::kUsage, uri + ": the baud rate after @ is no such thing"};
  }
  MIXRIG_ASSIGN(auto stream, device::open_byte_stream(parts.rest.substr(0, at)));
  MIXRIG_TRY(stream->set_line({.baud = baud}));
  MIXRIG_ASSIGN(auto unit, device::FlirPtu::open(std::move(stream), clock, uri));
  return std::unique_ptr<device::PanTilt>(std::move(unit));
}

Result<std::unique_ptr<device::TriggerMaster>> open_trigger(const std::string& uri, Clock& clock) {
  const Uri parts = split(uri);
  if (parts.scheme == "mcu") {
    MIXRIG_ASSIGN(auto stream, device::open_byte_stream(parts.rest));
    MIXRIG_ASSIGN(auto trigger, device::McuTrigger::open(std::move(stream), clock, uri));
    return std::unique_ptr<device::TriggerMaster>(std::move(trigger));
  }
#ifdef MIXRIG_HAVE_GPIOD
  if (parts.scheme == "gpiod") return device::open_gpiod_trigger(parts.rest, clock);
#endif
  return unknown(uri, "trigger", "mcu:/dev/ttyACM0 or gpiod:gpiochip0/17,18");
}

Result<void> apply_controls(const CameraConfig& config, device::Camera& camera) {
  const auto set = [&](device::CameraControl control,
                       const std::optional<double>& value) -> Result<void> {
    return value ? camera.set(control, *value) : Result<void>();
  };
  MIXRIG_TRY(set(device::CameraControl::kExposure, config.exposure_s));
  MIXRIG_TRY(set(device::CameraControl::kGain, config.gain));
  MIXRIG_TRY(set(device::CameraControl::kFocus, config.focus));
  return set(device::CameraControl::kWhiteBalance, config.white_balance_k);
}

Result<Devices> open_devices(const RigConfig& rig, Clock& clock) {
  Devices devices;
  if (!rig.trigger_uri.empty()) {
    MIXRIG_ASSIGN(devices.trigger, open_trigger(rig.trigger_uri, clock));
  }
  for (const CameraConfig& config : rig.cameras) {
    MIXRIG_ASSIGN(auto camera, open_camera(config.uri, config.request, clock));
    MIXRIG_TRY(apply_controls(config, *camera));
    devices.cameras.push_back(std::move(camera));
  }
  if (rig.depth) {
    MIXRIG_ASSIGN(devices.depth, open_depth(rig.depth->uri, rig.depth->request, clock));
  }
  if (!rig.pan_tilt_uri.empty()) {
    MIXRIG_ASSIGN(devices.pan_tilt, open_pan_tilt(rig.pan_tilt_uri, clock));
  }
  return devices;
}

}  // namespace mixrig::rig
