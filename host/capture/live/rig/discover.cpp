// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/discover.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>

#include "hal/base/log.h"
#include "hal/linux/aravis/aravis_camera.h"
#include "hal/linux/libcamera/libcamera_camera.h"
#include "hal/linux/libusb_streams.h"
#include "hal/linux/openni2/openni2_camera.h"
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

/// libcamera's ids of UVC cameras end with vendor and product: "...-1:1.0-046d:0825".
bool is_webcam(std::string_view libcamera_id) {
  constexpr std::size_t kTail = 10;
  if (libcamera_id.size() < kTail) return false;
  const std::string_view tail = libcamera_id.substr(libcamera_id.size() - kTail);
  for (std::size_t i = 0; i < kTail; ++i) {
    const bool mark = i == 0 || i == 5;
    const bool fits = mark ? tail[i] == (i == 0 ? '-' : ':')
                           : std::isxdigit(static_cast<unsigned char>(tail[i])) != 0;
    if (!fits) return false;
  }
  return true;
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

DeviceLists list_devices(const DiscoverOptions& options) {
  return {.v4l2 = nodes({"video"}),
          .libcamera = device::list_libcamera(),
          .aravis = options.network ? device::list_aravis() : std::vector<std::string>(),
          .openni2 = device::list_openni2(),
          .kinect2 = device::list_kinect2()};
}

std::vector<FoundCamera> find_cameras(const DeviceLists& lists, DeviceOpener& opener) {
  std::vector<FoundCamera> found;
  for (const std::string& uri : uris_to_open(lists)) {
    if (const auto camera = opener.camera(uri, {})) found.push_back({uri, (*camera)->info()});
    if (!uri.starts_with("openni2:")) continue;
    if (const auto depth = opener.depth(uri, {})) found.push_back({uri, (*depth)->info()});
  }
  for (FoundCamera& kinect : kinects_of(lists.kinect2)) found.push_back(std::move(kinect));
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

std::vector<std::string> uris_to_open(const DeviceLists& lists) {
  std::vector<std::string> uris;
  for (const std::string& node : lists.v4l2) uris.push_back("v4l2:" + node);
  for (const std::string& id : lists.libcamera)
    if (!is_webcam(id)) uris.push_back("libcamera:" + id);
  for (const std::string& id : lists.aravis) uris.push_back("aravis:" + id);
  for (const std::string& uri : lists.openni2) uris.push_back("openni2:" + uri);
  return uris;
}

std::vector<FoundCamera> kinects_of(const std::vector<std::string>& serials) {
  std::vector<FoundCamera> found;
  for (const std::string& serial : serials) {
    if (serial.empty() && serials.size() > 1) continue;
    const std::string uri = "kinect2:" + serial;
    device::CameraInfo color, depth;
    color.format = device::PixelFormat::kMjpeg;
    depth.format = device::PixelFormat::kDepth16;
    found.push_back({uri + "/color", color});
    found.push_back({uri, depth});
  }
  return found;
}

RigConfig rig_of(const std::vector<FoundCamera>& cameras, std::vector<std::string>& left_out) {
  RigConfig rig;
  rig.name = "found";
  const bool libcamera = std::any_of(cameras.begin(), cameras.end(), [](const FoundCamera& c) {
    return c.uri.starts_with("libcamera:");
  });
  for (const FoundCamera& camera : cameras) {
    const bool depth = camera.info.format == device::PixelFormat::kDepth16;
    if ((libcamera && is_raw_side(camera)) || (depth && rig.depth2))
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

RigConfig discover(const DiscoverOptions& options, Clock& clock) {
  DeviceOpener opener(clock);
  const DeviceLists lists = list_devices(options);
  std::vector<std::string> left_out;
  RigConfig rig = rig_of(find_cameras(lists, opener), left_out);
  for (const std::string& serial : lists.kinect2)
    if (serial.empty())
      log_warning("rig", "a Kinect v2 may not be opened: install the udev rules (board/udev)");
  for (const std::string& uri : left_out)
    log_warning("rig", uri +
                           " is left out of the rig: it holds two depth cameras at most, and no "
                           "V4L2 nodes of cameras that libcamera delivers");
  find_serial(opener, rig);
  return rig;
}

}  // namespace mixrig::live
