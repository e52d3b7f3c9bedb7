// SPDX-License-Identifier: Apache-2.0
#include "tests/board/nodes.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "tests/board/bench.h"

namespace mixrig::board {
namespace {

/// Whether the node delivers pictures; uvcvideo has a second node for metadata.
bool captures(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return false;
  v4l2_capability capability{};
  const bool known = ::ioctl(file, VIDIOC_QUERYCAP, &capability) == 0;
  ::close(file);
  return known && (capability.device_caps & V4L2_CAP_VIDEO_CAPTURE) != 0;
}

std::vector<std::string> video_nodes() {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator("/dev"))
    if (entry.path().filename().string().starts_with("video")) found.push_back(entry.path());
  return found;
}

}  // namespace

std::string plug_camera(VhciPort& port, const UsbDevice& device) {
  const std::string product = device.descriptors().strings[1];
  EXPECT_TRUE(wait_until([&] { return !has_usb(product); })) << product << " does not go away";
  const auto before = video_nodes();
  if (const auto plugged = port.plug(); !plugged) {
    ADD_FAILURE() << to_line(plugged.error());
    return {};
  }
  std::string node;
  wait_until([&] {
    for (const std::string& path : video_nodes())
      if (std::find(before.begin(), before.end(), path) == before.end() && captures(path))
        node = path;
    return !node.empty();
  });
  EXPECT_FALSE(node.empty()) << product << " has no node";
  return node;
}

bool plug_serial(VhciPort& port, const std::string& node) {
  const auto there = [&] { return std::filesystem::exists(node); };
  return wait_until([&] { return !there(); }) && port.plug() && wait_until(there);
}

bool has_node(const std::string& path) { return captures(path); }

bool has_usb(const std::string& product) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/bus/usb/devices", error)) {
    std::string name;
    std::getline(std::ifstream(entry.path() / "product") >> std::ws, name);
    if (name == product) return true;
  }
  return false;
}

bool UvcBench::plug() {
  node = plug_camera(port, device);
  return !node.empty();
}

}  // namespace mixrig::board
