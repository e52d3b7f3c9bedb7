// SPDX-License-Identifier: Apache-2.0
#include "tests/board/virtual_rig.h"

#include <fstream>
#include <numbers>
#include <utility>

#include "tests/board/bench.h"

namespace mixrig::board {
namespace {

constexpr const char* kTriggerNode = "/dev/ttyACM0";
constexpr const char* kHeadNode = "/dev/ttyACM1";

bool plug_in(VhciPort& port) {
  const auto plugged = port.plug();
  if (!plugged) ADD_FAILURE() << to_line(plugged.error());
  return plugged.has_value();
}

}  // namespace

VirtualRig::~VirtualRig() { trigger_port.unplug(); }  // it fires the other devices

bool VirtualRig::plug() {
  return plug_color() && plug_depth() && plug_serial(trigger_port, kTriggerNode) && plug_head();
}

bool VirtualRig::plug_depth() {
  const std::string product = depth.descriptors().strings[1];
  return wait_until([&] { return !has_usb(product); }) && plug_in(depth_port) &&
         wait_until([&] { return has_usb(product); });
}

bool VirtualRig::plug_head() { return plug_serial(head_port, kHeadNode); }

bool VirtualRig::plug_color() {
  color_node = plug_camera(color_port, color);
  if (color_node.empty()) return false;
  const auto mapped = map_trigger_control(color_node);
  if (!mapped) ADD_FAILURE() << to_line(mapped.error());
  return mapped.has_value();
}

void VirtualRig::show_room() {
  set_look([this](int line, device::PanTiltAngles at, HostTime) {
    if (line != kColorLine) return;
    std::vector<std::uint8_t> columns;
    for (int x = 0; x < kColorSize.width; ++x)
      columns.push_back(static_cast<std::uint8_t>(room.luminance(x, at.pan_rad)));
    color.show(std::move(columns));
  });
}

void VirtualRig::set_look(Look look) {
  const std::lock_guard lock(mutex_);
  look_ = std::move(look);
}

void VirtualRig::look(int line) {
  constexpr double kStep_rad = 185.1428 / 3600 * std::numbers::pi / 180;
  const std::lock_guard lock(mutex_);
  if (!look_) return;
  const HostTime now = SystemClock().now();
  const auto [pan, tilt] = head.position(now);
  look_(line, {kStep_rad * static_cast<double>(pan), kStep_rad * static_cast<double>(tilt)}, now);
}

void VirtualRig::fire(int line, std::uint32_t tick) {
  if (line == kColorLine) chip.pull(kEdgesLine, true);
  look(line);
  if (line == kColorLine) {
    color.fire(tick);
    color_port.wake();
    chip.pull(kEdgesLine, false);
  } else if (line == kDepthLine) {
    depth.fire(tick);
    depth_port.wake();
  }
}

void VirtualRig::write_config(const std::string& path) const {
  std::ofstream out(path);
  out << "format = 1\nname = \"virtual board\"\n[trigger]\nuri = \"mcu:" << kTriggerNode << "\"\n";
  if (!chip.name().empty())
    out << "[trigger.edges]\nuri = \"gpiod:" << chip.name() << "/" << kEdgesLine
        << "\"\nline = " << kColorLine << "\n";
  for (const int line : {kColorLine, kDepthLine})
    out << "[[trigger.line]]\nline = " << line << "\ndivider = " << kDivider
        << "\nwidth_ms = 1.0\n";
  out << "[[camera]]\nname = \"color\"\nuri = \"v4l2:" << color_node
      << "\"\nsize_px = [160, 90]\nformat = \"yuyv\"\ntrigger_line = " << kColorLine << "\n"
      << "[[camera]]\nname = \"side\"\nuri = \"v4l2:/dev/video0\"\nsize_px = [320, 180]\n"
      << "format = \"gray8\"\nrate_hz = 5\n"
      << "[[camera]]\nname = \"mono\"\nuri = \"aravis:Aravis-Fake-GV01\"\nsize_px = [64, 48]\n"
      << "format = \"gray8\"\nrate_hz = 5\n"
      << "[depth]\nuri = \"usb:1209:0001\"\ndelay_ms = 2.0\ntrigger_line = " << kDepthLine << "\n"
      << "[pan_tilt]\nuri = \"flir-ptu:" << kHeadNode << "\"\n";
}

}  // namespace mixrig::board
