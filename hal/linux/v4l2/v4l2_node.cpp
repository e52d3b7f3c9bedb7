// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/v4l2/v4l2_node.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include "hal/base/log.h"
#include "hal/linux/v4l2/v4l2_ioctl.h"

namespace mixrig::device {
namespace {

constexpr std::uint32_t kNodeBuffers = 4;

double rate(const v4l2_fract& interval) {
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator
                                : 0;
}

}  // namespace

V4l2Node& V4l2Node::operator=(V4l2Node&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(path_, other.path_);
  std::swap(mappings_, other.mappings_);
  return *this;
}

Error V4l2Node::failed(const char* what) const {
  const int reason = errno;
  return system_error(ErrorCode::kDevice, "v4l2:" + path_ + ": " + what + " failed", reason);
}

Result<V4l2Node> V4l2Node::open(const std::string& path) {
  V4l2Node node;
  node.path_ = path;
  node.fd_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (node.fd_ < 0)
    return system_error(errno == ENOENT || errno == ENODEV ? ErrorCode::kNotFound : ErrorCode::kIo,
                        "v4l2:" + path + ": cannot be opened: check the cable and the group video",
                        errno);
  v4l2_capability capability{};
  if (ioctl_again(node.fd_, VIDIOC_QUERYCAP, &capability) < 0)
    return Error{ErrorCode::kDevice, "v4l2:" + path + ": is not a video device"};
  const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                ? capability.device_caps
                                : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0)
    return Error{ErrorCode::kDevice,
                 "v4l2:" + path + ": does not stream pictures: try another node"};
  return node;
}

Result<V4l2Layout> V4l2Node::configure(const StreamRequest& request, CameraInfo& info) {
  const auto offered = modes();
  MIXRIG_ASSIGN(const V4l2Choice choice, choose_mode(offered, request));
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = static_cast<std::uint32_t>(choice.size.width);
  format.fmt.pix.height = static_cast<std::uint32_t>(choice.size.height);
  format.fmt.pix.pixelformat = choice.code;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  if (ioctl_again(fd_, VIDIOC_S_FMT, &format) < 0) return failed("setting the format");
  const auto& pix = format.fmt.pix;
  MIXRIG_ASSIGN(V4l2Layout layout, checked_layout(pix.pixelformat, pix.width, pix.height,
                                                  pix.bytesperline, pix.sizeimage));
  if (layout.format != choice.format || layout.size != choice.size)
    return Error{ErrorCode::kDevice,
                 "v4l2:" + path_ + ": the driver did not accept a mode that it offers"};
  v4l2_capability capability{};
  if (ioctl_again(fd_, VIDIOC_QUERYCAP, &capability) == 0) {
    info.model = v4l2_text(capability.card);
    info.serial = v4l2_text(capability.bus_info);
  }
  info.size = layout.size;
  info.format = layout.format;
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
    description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
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
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (ioctl_again(fd_, VIDIOC_G_PARM, &parameters) < 0) return 0;
  auto& interval = parameters.parm.capture.timeperframe;
  if (rate_hz > 0) {
    interval = {1000, static_cast<std::uint32_t>(std::lround(rate_hz * 1000))};
    // Not every driver supports it; the rate that the driver returns counts.
    (void)ioctl_again(fd_, VIDIOC_S_PARM, &parameters);
  }
  return rate(interval);
}

Result<void> V4l2Node::start_streaming() {
  v4l2_requestbuffers request{};
  request.count = kNodeBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (ioctl_again(fd_, VIDIOC_REQBUFS, &request) < 0) return failed("requesting buffers");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer{};
    buffer.index = i;
    buffer.type = request.type;
    buffer.memory = request.memory;
    if (ioctl_again(fd_, VIDIOC_QUERYBUF, &buffer) < 0) return failed("querying a buffer");
    void* address =
        ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, buffer.m.offset);
    if (address == MAP_FAILED) return failed("mapping a buffer");
    mappings_.push_back({address, buffer.length});
    if (ioctl_again(fd_, VIDIOC_QBUF, &buffer) < 0) return failed("queueing a buffer");
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (ioctl_again(fd_, VIDIOC_STREAMON, &type) < 0) return failed("starting the stream");
  return {};
}

Result<std::optional<V4l2Picture>> V4l2Node::next(Duration timeout) {
  pollfd poll{fd_, POLLIN, 0};
  const int wait_ms =
      static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(timeout).count());
  const int ready = ::poll(&poll, 1, wait_ms);
  if (ready == 0 || (ready < 0 && errno == EINTR)) return std::optional<V4l2Picture>();
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (ioctl_again(fd_, VIDIOC_DQBUF, &buffer) < 0) {
    if (errno == EAGAIN) return std::optional<V4l2Picture>();
    return failed("taking a picture");
  }
  if (buffer.index >= mappings_.size())
    return Error{ErrorCode::kDevice, "v4l2:" + path_ + ": the driver returned an unknown buffer"};
  const Mapping& mapping = mappings_[buffer.index];
  const std::uint32_t source = buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK;
  return std::optional<V4l2Picture>(V4l2Picture{
      .bytes = {static_cast<const std::uint8_t*>(mapping.address),
                std::min<std::size_t>(buffer.bytesused, mapping.bytes)},
      .index = buffer.index,
      .sequence = buffer.sequence,
      .stamp = HostTime(std::chrono::seconds(buffer.timestamp.tv_sec) +
                        std::chrono::microseconds(buffer.timestamp.tv_usec)),
      .stamp_valid =
          (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC,
      .stamp_is_start = source == V4L2_BUF_FLAG_TSTAMP_SRC_SOE,
      .error = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0});
}

Result<void> V4l2Node::give_back(const V4l2Picture& picture) {
  v4l2_buffer buffer{};
  buffer.index = picture.index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (ioctl_again(fd_, VIDIOC_QBUF, &buffer) < 0) return failed("returning a buffer");
  return {};
}

void V4l2Node::close() {
  for (const Mapping& mapping : mappings_) ::munmap(mapping.address, mapping.bytes);
  mappings_.clear();
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

}  // namespace mixrig::device
