// SPDX-License-Identifier: Apache-2.0
// Exposure, gain, focus, white balance, zoom and hardware trigger of a V4L2 node.
#include <array>
#include <cmath>

#include <linux/videodev2.h>

#include "hal/linux/v4l2/v4l2_ioctl.h"
#include "hal/linux/v4l2/v4l2_node.h"

namespace mixrig::device {
namespace {

/// A control, the control that selects its manual mode (0: none), and the unit of its steps.
struct Mapped {
  CameraControl control;
  std::uint32_t id;
  std::uint32_t automatic_id;
  std::int32_t manual_value;
  double unit;  ///< value = steps * unit
};
constexpr std::array<Mapped, kCameraControls> kMapped = {{
    {CameraControl::kExposure, V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_EXPOSURE_AUTO,
     V4L2_EXPOSURE_MANUAL, 1e-4},
    {CameraControl::kGain, V4L2_CID_GAIN, V4L2_CID_AUTOGAIN, 0, 1},
    {CameraControl::kFocus, V4L2_CID_FOCUS_ABSOLUTE, V4L2_CID_FOCUS_AUTO, 0, 1},
    {CameraControl::kWhiteBalance, V4L2_CID_WHITE_BALANCE_TEMPERATURE, V4L2_CID_AUTO_WHITE_BALANCE,
     0, 1},
    {CameraControl::kZoom, V4L2_CID_ZOOM_ABSOLUTE, 0, 0, 1},
}};
const Mapped& mapped(CameraControl control) { return kMapped[static_cast<std::size_t>(control)]; }

}  // namespace

/// No standard control exists; drivers of machine-vision cameras name theirs "Trigger Mode".
bool V4l2Node::set_hardware_trigger(bool on) const {
  v4l2_queryctrl query{};
  for (std::uint32_t i = 0; i < kMostV4l2Entries; ++i) {
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    if (ioctl_again(fd_, VIDIOC_QUERYCTRL, &query) < 0) return false;
    const std::string control = v4l2_text(query.name);
    if (control == "Trigger Mode" || control == "trigger_mode")
      return write_control(query.id, on ? 1 : 0) && on;
  }
  return false;
}

std::vector<ControlRange> V4l2Node::controls() const {
  std::vector<ControlRange> ranges;
  for (const Mapped& m : kMapped) {
    v4l2_queryctrl query{};
    query.id = m.id;
    if (ioctl_again(fd_, VIDIOC_QUERYCTRL, &query) < 0 ||
        (query.flags & V4L2_CTRL_FLAG_DISABLED) != 0)
      continue;
    ranges.push_back(
        {m.control, query.minimum * m.unit, query.maximum * m.unit, query.step * m.unit});
  }
  return ranges;
}

bool V4l2Node::write_control(std::uint32_t id, std::int32_t value) const {
  v4l2_control control{id, value};
  return ioctl_again(fd_, VIDIOC_S_CTRL, &control) == 0;
}

Result<void> V4l2Node::set(CameraControl control, double value) {
  const Mapped& m = mapped(control);
  // May fail: a camera without the automatic mode has no control to turn it off.
  if (m.automatic_id != 0) (void)write_control(m.automatic_id, m.manual_value);
  if (!write_control(m.id, static_cast<std::int32_t>(std::lround(value / m.unit))))
    return failed("setting a control");
  return {};
}

Result<double> V4l2Node::get(CameraControl control) const {
  const Mapped& m = mapped(control);
  v4l2_control value{m.id, 0};
  if (ioctl_again(fd_, VIDIOC_G_CTRL, &value) < 0) return failed("reading a control");
  return value.value * m.unit;
}

}  // namespace mixrig::device
