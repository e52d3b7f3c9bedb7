// SPDX-License-Identifier: Apache-2.0
#include "host/live/discover.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "hal/linux/aravis/aravis_camera.h"
#include "hal/linux/openni2/openni2_camera.h"
#include "host/live/devices.h"

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

void add(const std::string& uri, const device::CameraInfo& info, RigConfig& rig) {
  CameraConfig camera;
  camera.uri = uri;
  camera.request = {.size = info.size, .format = info.format, .rate_hz = info.rate_hz};
  const bool depth = info.format == device::PixelFormat::kDepth16;
  camera.name = depth                 ? "depth"
                : rig.cameras.empty() ? "color"
                                      : "camera" + std::to_string(rig.cameras.size() + 1);
  if (!depth)
    rig.cameras.push_back(camera);
  else if (!rig.depth)
    rig.depth = camera;
}

void find_cameras(const DiscoverOptions& options, DeviceOpener& opener, RigConfig& rig) {
  for (const std::string& node : nodes({"video"}))
    if (const auto camera = opener.camera("v4l2:" + node, {}))
      add("v4l2:" + node, (*camera)->info(), rig);
  if (options.network)
    for (const std::string& id : device::list_aravis())
      if (const auto camera = opener.camera("aravis:" + id, {}))
        add("aravis:" + id, (*camera)->info(), rig);
  for (const std::string& id : device::list_openni2()) {
    const std::string uri = "openni2:" + id;
    if (const auto camera = opener.camera(uri, {})) add(uri, (*camera)->info(), rig);
    if (const auto depth = opener.depth(uri, {})) add(uri, (*depth)->info(), rig);
  }
  if (const auto tof = opener.depth(kTofUsb, {})) add(kTofUsb, (*tof)->info(), rig);
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

RigConfig discover(const DiscoverOptions& options, Clock& clock) {
  RigConfig rig;
  rig.name = "found";
  DeviceOpener opener(clock);
  find_cameras(options, opener, rig);
  find_serial(opener, rig);
  return rig;
}

}  // namespace mixrig::live
