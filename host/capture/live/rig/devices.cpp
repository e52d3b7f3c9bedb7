// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/devices.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "hal/linux/aravis/aravis_camera.h"
#include "hal/linux/gpiod/gpiod_lines.h"
#include "hal/linux/serial_byte_stream.h"
#include "hal/linux/tof_usb_camera.h"
#include "hal/linux/v4l2/realsense_unit.h"
#include "hal/linux/v4l2/v4l2_camera.h"
#include "hal/wire/camera/realsense_table.h"
#include "hal/wire/camera/v4l2_format.h"
#include "hal/wire/pan_tilt/flir_ptu.h"
#include "hal/wire/pan_tilt/flir_ptu_baud.h"
#include "hal/wire/reopening_byte_stream.h"
#include "hal/wire/trigger/mcu_trigger.h"
#include "host/capture/live/rig/depth_phases.h"

namespace mixrig::live {
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

Error unknown(const std::string& uri, const char* what, const std::string& known) {
  return Error{ErrorCode::kUsage, "'" + uri + "' is not a " + what + ": use " + known};
}

/// A serial line that is reopened after its cable was unplugged.
Result<std::unique_ptr<device::ByteStream>> open_line(const std::string& name, Clock& clock) {
  return device::ReopeningByteStream::make([name] { return device::open_byte_stream(name); },
                                           clock);
}

constexpr std::string_view kTakeScheme = "take";

/// One picture stream of a recording: "take:DIR/color" is DIR and "color".
struct StreamUri {
  std::string recording, name;
};
StreamUri stream_uri(const Uri& uri) {
  const auto slash = uri.rest.rfind('/');
  if (slash == std::string::npos) return {uri.scheme + ":", uri.rest};
  return {uri.scheme + ":" + uri.rest.substr(0, slash), uri.rest.substr(slash + 1)};
}

}  // namespace

bool DeviceOpener::is_recording(const std::string& scheme) const {
  return scheme == kTakeScheme ||
         std::any_of(recordings_.begin(), recordings_.end(),
                     [&](const Recording& r) { return split(r.uri).scheme == scheme; });
}

std::vector<std::string> recordings_of(const RigConfig& rig,
                                       std::span<const std::string_view> schemes) {
  std::vector<std::string> uris;
  const auto add = [&](const std::string& uri) {
    const Uri parts = split(uri);
    const std::string recording = stream_uri(parts).recording;
    const bool played = parts.scheme == kTakeScheme ||
                        std::find(schemes.begin(), schemes.end(), parts.scheme) != schemes.end();
    if (played && std::find(uris.begin(), uris.end(), recording) == uris.end())
      uris.push_back(recording);
  };
  for (const CameraConfig& camera : rig.cameras) add(camera.uri);
  if (rig.depth) add(rig.depth->uri);
  if (rig.depth2) add(rig.depth2->uri);
  if (!rig.pan_tilt_uri.empty()) add(rig.pan_tilt_uri);
  return uris;
}

Result<std::shared_ptr<Player>> DeviceOpener::open_player(const std::string& recording) {
  for (const auto& [name, player] : players_)
    if (name == recording) return player;
  for (Recording& known : recordings_) {
    if (known.uri != recording) continue;
    if (!known.source) return known.source.error();
    auto player = Player::create(*std::move(known.source), recording, clock_);
    if (!player) {
      known.source = player.error();  // its source is used up; another device may ask again
      return player.error();
    }
    if (play_at_) (*player)->play_at(*play_at_);
    players_.emplace_back(recording, *player);
    return *player;
  }
  return Error{ErrorCode::kUsage, recording + ": recordings cannot be played as devices here"};
}

Result<std::unique_ptr<device::Camera>> DeviceOpener::camera(const std::string& uri,
                                                             const device::StreamRequest& request) {
  const Uri parts = split(uri);
  if (parts.scheme == "v4l2") {
    MIXRIG_ASSIGN(auto camera, device::V4l2Camera::open(parts.rest, request, clock_));
    return std::unique_ptr<device::Camera>(std::move(camera));
  }
  if (parts.scheme == "aravis") return device::open_aravis(parts.rest, request, clock_);
  if (const Kind* kind = kind_of(parts.scheme)) {
    if (kind->kind.left_out()) return extra_left_out(uri, kind->kind.extra);
    if (!kind->kind.camera_uri.empty()) return kind->driver->camera(parts.rest, request);
  }
  const StreamUri view = stream_uri(parts);
  if (is_recording(parts.scheme) &&
      (view.name == "color" || view.name == "rgb" || view.name == "target")) {
    MIXRIG_ASSIGN(const auto player, open_player(view.recording));
    return player->camera();
  }
  if (is_recording(parts.scheme) && view.name == "fisheye") {
    MIXRIG_ASSIGN(const auto player, open_player(view.recording));
    return player->fisheye();
  }
  return unknown(uri, "camera",
                 "v4l2:/dev/videoN, aravis:ID, " + known_uris(&DeviceKind::camera_uri) +
                     "take:DIR/color or take:DIR/fisheye");
}

Result<std::unique_ptr<device::DepthCamera>> DeviceOpener::depth(
    const std::string& uri, const device::StreamRequest& request) {
  const Uri parts = split(uri);
  if (parts.scheme == "usb") return device::open_tof_usb(parts.rest, clock_);
  if (parts.scheme == "v4l2") {
    device::StreamRequest depth = request;
    if (depth.format == device::PixelFormat::kUnknown) depth.format = device::PixelFormat::kDepth16;
    MIXRIG_ASSIGN(auto camera, device::V4l2Camera::open(parts.rest, depth, clock_));
    // Y16 holds steps whose meaning the device does not report.
    const device::CameraInfo& info = camera->info();
    const auto unit_m = info.format == device::PixelFormat::kDepth16
                            ? device::z16_metres_per_step(info.usb_vendor, info.usb_product)
                            : std::nullopt;
    device::DepthInfo steps{.metres_per_step = unit_m.value_or(0.001),
                            .unit_known = unit_m.has_value()};
    if (device::is_realsense_d400(info.usb_vendor, info.usb_product)) {
      if (const auto factory = device::realsense_intrinsics(parts.rest, info.size))
        steps.intrinsics = *factory;
      else
        log_warning("rig", to_line(factory.error()) + ": run mixrig calibrate");
    }
    return device::as_depth_camera(std::move(camera), steps);
  }
  if (parts.scheme == "aravis") return device::open_aravis_depth(parts.rest, request, clock_);
  if (const Kind* kind = kind_of(parts.scheme)) {
    if (kind->kind.left_out()) return extra_left_out(uri, kind->kind.extra);
    if (!kind->kind.depth_uri.empty()) return kind->driver->depth(parts.rest, request);
  }
  const StreamUri view = stream_uri(parts);
  if (is_recording(parts.scheme) && (view.name == "depth2" || view.name == "tof2")) {
    MIXRIG_ASSIGN(const auto player, open_player(view.recording));
    return player->depth2();
  }
  if (is_recording(parts.scheme) && (view.name == "depth" || view.name == "tof")) {
    MIXRIG_ASSIGN(const auto player, open_player(view.recording));
    return player->depth();
  }
  return unknown(uri, "depth camera",
                 "usb:VVVV:PPPP, v4l2:/dev/videoN, aravis:ID, " +
                     known_uris(&DeviceKind::depth_uri) + "or take:DIR/depth");
}

Result<std::unique_ptr<device::PanTilt>> DeviceOpener::pan_tilt(const std::string& uri) {
  const Uri parts = split(uri);
  if (const StreamUri view = stream_uri(parts); is_recording(parts.scheme) && view.name == "head") {
    MIXRIG_ASSIGN(const auto player, open_player(view.recording));
    return player->pan_tilt();
  }
  if (parts.scheme != "flir-ptu")
    return unknown(uri, "pan-tilt unit",
                   "flir-ptu:/dev/ttyUSB0, flir-ptu:tcp:HOST:PORT or take:DIR/head");
  const auto at = parts.rest.rfind('@');
  int baud = kPtuBaud;
  const bool find = at != std::string::npos && parts.rest.substr(at + 1) == "find";
  if (at != std::string::npos && !find) {
    const char* end = parts.rest.data() + parts.rest.size();
    const auto [stop, fault] = std::from_chars(parts.rest.data() + at + 1, end, baud);
    if (fault != std::errc() || stop != end || baud < 300 || baud > 4'000'000)
      return Error{ErrorCode::kUsage,
                   uri + ": the baud rate after @ is not valid: give 300 to 4000000, or find"};
  }
  MIXRIG_ASSIGN(auto stream, open_line(parts.rest.substr(0, at), clock_));
  if (find) {
    auto found = device::find_ptu_baud(*stream, clock_);
    if (!found) return Error{found.error().code, uri + ": " + found.error().context};
    baud = *found;
  }
  MIXRIG_TRY(stream->set_line({.baud = baud}));
  // On a network a byte takes no time, except on a serial line behind a server, whose rate is
  // given.
  const bool network = parts.rest.starts_with("tcp:") && at == std::string::npos;
  const Duration byte_time =
      network ? Duration(0) : std::chrono::duration_cast<Duration>(std::chrono::seconds(10)) / baud;
  MIXRIG_ASSIGN(auto unit, device::FlirPtu::open(std::move(stream), clock_, uri, byte_time));
  return std::unique_ptr<device::PanTilt>(std::move(unit));
}

Result<std::unique_ptr<device::TriggerMaster>> DeviceOpener::trigger(const std::string& uri) {
  const Uri parts = split(uri);
  if (parts.scheme == "mcu") {
    MIXRIG_ASSIGN(auto stream, open_line(parts.rest, clock_));
    MIXRIG_ASSIGN(auto trigger, device::McuTrigger::open(std::move(stream), clock_, uri));
    return std::unique_ptr<device::TriggerMaster>(std::move(trigger));
  }
  if (parts.scheme == "gpiod") return device::open_gpiod_trigger(parts.rest, clock_);
  return unknown(uri, "trigger", "mcu:/dev/ttyACM0 or gpiod:gpiochip0/17,18");
}

Result<std::unique_ptr<device::TriggerInput>> DeviceOpener::edges(const std::string& uri) {
  const Uri parts = split(uri);
  if (parts.scheme == "gpiod") return device::open_gpiod_input(parts.rest);
  return unknown(uri, "trigger input", "gpiod:gpiochip0/17");
}

Result<void> apply_controls(const CameraConfig& config, device::Camera& camera) {
  const auto set = [&](device::CameraControl control,
                       const std::optional<double>& value) -> Result<void> {
    return value ? camera.set(control, *value) : Result<void>();
  };
  MIXRIG_TRY(set(device::CameraControl::kExposure, config.exposure_s));
  MIXRIG_TRY(set(device::CameraControl::kGain, config.gain));
  MIXRIG_TRY(set(device::CameraControl::kFocus, config.focus));
  MIXRIG_TRY(set(device::CameraControl::kWhiteBalance, config.white_balance_k));
  return set(device::CameraControl::kZoom, config.zoom);
}

Result<void> check_unit(const RigConfig& rig, const device::DepthCamera& camera,
                        const DepthConfig* steps) {
  if ((steps != nullptr ? *steps : rig.depth_steps).applied_to(camera.depth()).unit_known)
    return {};
  return Error{
      ErrorCode::kUsage,
      fmt::format("{}: \"{}\" does not report the length of a depth step: give [depth] a unit_m "
                  "in {} (0.001 for millimetres)",
                  camera.info().uri, camera.info().model, rig.file.string())};
}

namespace {

/// Adds the file and key to an error.
Error at_lens_uri(const RigConfig& rig, Error error) {
  error.context = rig.file.string() + ": lens.uri: " + error.context;
  return error;
}

Result<Devices> open_all(const RigConfig& rig, DeviceOpener& opener) {
  Devices devices;
  if (rig.play_at) opener.play_at(*rig.play_at);
  if (!rig.lens_uri.empty()) {
    auto lens = opener.lens(rig.lens_uri);
    if (!lens) return at_lens_uri(rig, lens.error());
    devices.lens = *lens;
  }
  if (!rig.trigger_uri.empty()) {
    MIXRIG_ASSIGN(devices.trigger, opener.trigger(rig.trigger_uri));
  }
  if (!rig.edges_uri.empty()) {
    MIXRIG_ASSIGN(devices.edges, opener.edges(rig.edges_uri));
  }
  for (const CameraConfig& config : rig.cameras) {
    MIXRIG_ASSIGN(auto camera, opener.camera(config.uri, config.request));
    MIXRIG_TRY(apply_controls(config, *camera));
    devices.cameras.push_back(std::move(camera));
  }
  if (rig.depth) {
    MIXRIG_ASSIGN(devices.depth, opener.depth(rig.depth->uri, rig.depth->request));
    MIXRIG_TRY(check_unit(rig, *devices.depth));
  }
  if (rig.depth2) {
    MIXRIG_ASSIGN(devices.depth2, opener.depth(rig.depth2->uri, rig.depth2->request));
    MIXRIG_TRY(check_unit(rig, *devices.depth2, &rig.depth2_steps));
    if (const DepthPhases phases = depth_phases(rig); !phases.known)
      log_warning("rig", phases.line);
  }
  if (!rig.pan_tilt_uri.empty()) {
    MIXRIG_ASSIGN(devices.pan_tilt, opener.pan_tilt(rig.pan_tilt_uri));
  }
  devices.player = opener.player();
  return devices;
}

}  // namespace

Result<Devices> open_devices(const RigConfig& rig, DeviceOpener opener) {
  auto devices = open_all(rig, opener);
  // A recording that is missing is a wrong file.
  if (devices || opener.plays() || devices.error().code != ErrorCode::kNotFound) return devices;
  Error missing = devices.error();
  missing.code = ErrorCode::kDevice;
  return missing;
}

}  // namespace mixrig::live
