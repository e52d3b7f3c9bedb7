// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/discover.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>

#include "hal/base/log.h"
#include "hal/linux/aravis/aravis_camera.h"
#include "host/capture/live/rig/devices.h"

namespace mixrig::live {
namespace {

constexpr const char* kTofUsb = "usb:1209:0001";

/// Device files whose names begin with one of `prefixes`, in order.
std::vector<std::string> nodes(std::initializer_list<std::string_view> prefixes) {
  std::vector<std::string> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
    const std::string name = entry.path().filename();
    for (const std::string_view prefix : prefixes)
      if (name.starts_with(prefix)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

bool is_raw_side(const FoundCamera& camera) {
  return camera.uri.starts_with("v4l2:") && camera.info.usb_vendor == 0;
}

CameraConfig config_of(const FoundCamera& camera, std::string name) {
  CameraConfig config;
  config.name = std::move(name);
  config.uri = camera.uri;
  if (!camera.info.size.empty())
    config.request = {
        .size = camera.info.size, .format = camera.info.format, .rate_hz = camera.info.rate_hz};
  return config;
}

/// Appends the cameras of `uris` that answer.
void look_at(const std::vector<std::string>& uris, DeviceOpener& opener,
             std::vector<FoundCamera>& found) {
  for (const std::string& uri : uris)
    if (const auto camera = opener.camera(uri, {})) found.push_back({uri, (*camera)->info()});
}

std::vector<std::string> with_scheme(const char* scheme, std::vector<std::string> names) {
  for (std::string& name : names) name.insert(0, scheme);
  return names;
}

/// Returns the cameras in the order that decides which one is the target camera: V4L2 nodes,
/// processed cameras, GenICam cameras, those of other kinds, the ToF camera of the open protocol.
std::vector<FoundCamera> find_cameras(const DiscoverOptions& options, DeviceOpener& opener) {
  std::vector<FoundCamera> found;
  look_at(with_scheme("v4l2:", nodes({"video"})), opener, found);
  std::vector<FoundCamera> of_kinds = opener.find();
  const auto others = std::stable_partition(of_kinds.begin(), of_kinds.end(),
                                            [](const FoundCamera& c) { return c.processed; });
  std::move(of_kinds.begin(), others, std::back_inserter(found));
  if (options.network) look_at(with_scheme("aravis:", device::list_aravis()), opener, found);
  std::move(others, of_kinds.end(), std::back_inserter(found));
  if (const auto tof = opener.depth(kTofUsb, {})) found.push_back({kTofUsb, (*tof)->info()});
  return found;
}

void find_serial(DeviceOpener& opener, RigConfig& rig) {
  for (const std::string& node : nodes({"ttyACM", "ttyUSB"})) {
    if (rig.trigger_uri.empty() && opener.trigger("mcu:" + node))
      rig.trigger_uri = "mcu:" + node;
    else if (rig.pan_tilt_uri.empty() && opener.pan_tilt("flir-ptu:" + node))
      rig.pan_tilt_uri = "flir-ptu:" + node;
  }
}

}  // namespace

RigConfig rig_of(const std::vector<FoundCamera>& cameras, std::vector<std::string>& left_out) {
  RigConfig rig;
  rig.name = "found";
  const bool processed =
      std::any_of(cameras.begin(), cameras.end(), [](const FoundCamera& c) { return c.processed; });
  for (const FoundCamera& camera : cameras) {
    const bool depth = camera.info.format == device::PixelFormat::kDepth16;
    if ((processed && is_raw_side(camera)) || (depth && rig.depth2))
      left_out.push_back(camera.uri);
    else if (!depth)
      rig.cameras.push_back(config_of(
          camera,
          rig.cameras.empty() ? "color" : "camera" + std::to_string(rig.cameras.size() + 1)));
    else if (!rig.depth)
      rig.depth = config_of(camera, "depth");
    else
      rig.depth2 = config_of(camera, "depth2");
  }
  return rig;
}

RigConfig discover(const DiscoverOptions& options, std::span<const DeviceKind> kinds,
                   Clock& clock) {
  DeviceOpener opener(clock, {}, kinds);
  std::vector<std::string> left_out;
  RigConfig rig = rig_of(find_cameras(options, opener), left_out);
  for (const std::string& uri : left_out)
    log_warning("rig", uri +
                           " is left out of the rig: it holds two depth cameras at most, and no "
                           "V4L2 nodes that are the raw side of a processed camera");
  find_serial(opener, rig);
  return rig;
}

}  // namespace mixrig::live
