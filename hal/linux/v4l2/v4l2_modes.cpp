// SPDX-License-Identifier: Apache-2.0
// Reads the modes that a V4L2 node offers, and sets one.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>

#include <linux/videodev2.h>

#include "hal/base/log.h"
#include "hal/linux/v4l2/v4l2_ioctl.h"
#include "hal/linux/v4l2/v4l2_node.h"

namespace mixrig::device {
namespace {

double rate(const v4l2_fract& interval) {
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator
                                : 0;
}

v4l2_format wanted_format(const V4l2Choice& choice, std::uint32_t type) {
  v4l2_format format{};
  format.type = type;
  const auto width = static_cast<std::uint32_t>(choice.size.width),
             height = static_cast<std::uint32_t>(choice.size.height);
  const auto fill = [&](auto& pix) {
    pix.width = width, pix.height = height;
    pix.pixelformat = choice.code;
    pix.field = V4L2_FIELD_NONE;
  };
  if (type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE)
    fill(format.fmt.pix_mp);
  else
    fill(format.fmt.pix);
  return format;
}

Result<V4l2Layout> layout_of(const v4l2_pix_format& pix, ColorEncoding& color) {
  V4l2Colors colors{.colorspace = pix.colorspace};
  // Older drivers leave what follows the picture's size undefined.
  if (pix.priv == V4L2_PIX_FMT_PRIV_MAGIC)
    colors = {pix.colorspace, pix.ycbcr_enc, pix.quantization, pix.xfer_func};
  color = encoding_of(colors);
  const V4l2Plane plane{pix.bytesperline, pix.sizeimage};
  return checked_layout(pix.pixelformat, pix.width, pix.height, {&plane, 1});
}

Result<V4l2Layout> layout_of(const v4l2_pix_format_mplane& pix, ColorEncoding& color) {
  color = encoding_of({pix.colorspace, pix.ycbcr_enc, pix.quantization, pix.xfer_func});
  std::array<V4l2Plane, VIDEO_MAX_PLANES> planes;
  const std::size_t count = std::min<std::size_t>(pix.num_planes, planes.size());
  for (std::size_t i = 0; i < count; ++i)
    planes[i] = {pix.plane_fmt[i].bytesperline, pix.plane_fmt[i].sizeimage};
  return checked_layout(pix.pixelformat, pix.width, pix.height,
                        std::span<const V4l2Plane>(planes).first(count));
}

/// Returns idVendor or idProduct of the USB device behind a node, hexadecimal in sysfs; 0 if there
/// is none.
std::uint16_t usb_number(const std::string& path, const char* key) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path node = fs::canonical(path, ignored).filename();
  std::ifstream file(fs::path("/sys/class/video4linux") / node / "device" / ".." / key);
  unsigned number = 0;
  file >> std::hex >> number;
  return file ? static_cast<std::uint16_t>(number) : std::uint16_t{0};
}

}  // namespace

Result<V4l2Layout> V4l2Node::configure(const StreamRequest& request, CameraInfo& info) {
  const auto offered = modes();
  MIXRIG_ASSIGN(const V4l2Choice choice, choose_mode(offered, request));
  v4l2_format format = wanted_format(choice, type_);
  if (ioctl_again(fd_, VIDIOC_S_FMT, &format) < 0) return failed("setting the format");
  MIXRIG_ASSIGN(V4l2Layout layout, multi_planar() ? layout_of(format.fmt.pix_mp, info.color)
                                                  : layout_of(format.fmt.pix, info.color));
  if (layout.format != choice.format || layout.size != choice.size)
    return Error{ErrorCode::kDevice,
                 "v4l2:" + path_ + ": the driver did not accept a mode that it offers"};
  planes_ = layout.planes;
  v4l2_capability capability{};
  if (ioctl_again(fd_, VIDIOC_QUERYCAP, &capability) == 0) {
    info.model = v4l2_text(capability.card);
    info.serial = v4l2_text(capability.bus_info);
  }
  info.usb_vendor = usb_number(path_, "idVendor");
  info.usb_product = usb_number(path_, "idProduct");
  info.size = layout.size;
  info.format = layout.format;
  info.sample_bits = layout.sample_bits;
  info.rate_hz = set_rate(request.rate_hz);
  info.hardware_trigger = set_hardware_trigger(request.hardware_trigger);
  if (request.hardware_trigger && !info.hardware_trigger)
    log_warning("v4l2",
                path_ + ": has no trigger control: make sure that it is set to its trigger input");
  info.controls = controls();
  return layout;
}

std::vector<V4l2Mode> V4l2Node::modes() const {
  std::vector<V4l2Mode> found;
  for (std::uint32_t i = 0; i < kMostV4l2Entries; ++i) {
    v4l2_fmtdesc description{};
    description.index = i;
    description.type = type_;
    if (ioctl_again(fd_, VIDIOC_ENUM_FMT, &description) < 0) break;
    if (format_of_fourcc(description.pixelformat) != PixelFormat::kUnknown)
      add_sizes(description.pixelformat, found);
  }
  return found;
}

void V4l2Node::add_sizes(std::uint32_t code, std::vector<V4l2Mode>& found) const {
  for (std::uint32_t i = 0; i < kMostV4l2Entries; ++i) {
    v4l2_frmsizeenum entry{};
    entry.index = i;
    entry.pixel_format = code;
    if (ioctl_again(fd_, VIDIOC_ENUM_FRAMESIZES, &entry) < 0) return;
    V4l2Mode mode{.code = code};
    if (entry.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      mode.minimum = mode.maximum = {static_cast<int>(entry.discrete.width),
                                     static_cast<int>(entry.discrete.height)};
    } else {
      const auto& range = entry.stepwise;
      mode.minimum = {static_cast<int>(range.min_width), static_cast<int>(range.min_height)};
      mode.maximum = {static_cast<int>(range.max_width), static_cast<int>(range.max_height)};
      mode.step = {static_cast<int>(std::max(1U, range.step_width)),
                   static_cast<int>(std::max(1U, range.step_height))};
    }
    mode.max_rate_hz = max_rate(code, mode.maximum);
    found.push_back(mode);
    if (entry.type != V4L2_FRMSIZE_TYPE_DISCRETE) return;
  }
}

double V4l2Node::max_rate(std::uint32_t code, Size size) const {
  double best = 0;
  for (std::uint32_t i = 0; i < kMostV4l2Entries; ++i) {
    v4l2_frmivalenum entry{};
    entry.index = i;
    entry.pixel_format = code;
    entry.width = static_cast<std::uint32_t>(size.width);
    entry.height = static_cast<std::uint32_t>(size.height);
    if (ioctl_again(fd_, VIDIOC_ENUM_FRAMEINTERVALS, &entry) < 0) break;
    const bool discrete = entry.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    best = std::max(best, rate(discrete ? entry.discrete : entry.stepwise.min));
    if (!discrete) break;
  }
  return best;
}

double V4l2Node::set_rate(double rate_hz) const {
  v4l2_streamparm parameters{};
  parameters.type = type_;
  if (ioctl_again(fd_, VIDIOC_G_PARM, &parameters) < 0) return 0;
  auto& interval = parameters.parm.capture.timeperframe;
  if (rate_hz > 0) {
    interval = {1000, static_cast<std::uint32_t>(std::lround(rate_hz * 1000))};
    // Not every driver supports it; the rate that the driver returns counts.
    (void)ioctl_again(fd_, VIDIOC_S_PARM, &parameters);
  }
  return rate(interval);
}

}  // namespace mixrig::device
