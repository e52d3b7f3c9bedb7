// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/v4l2/v4l2_node.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include "hal/linux/v4l2/v4l2_ioctl.h"

namespace mixrig::device {
namespace {

constexpr std::uint32_t kNodeBuffers = 4;
// Frames that wait for the compositor, are composited, or are shown: eight at most.
constexpr std::uint32_t kLentBuffers = 8;

}  // namespace

/// A v4l2_buffer with its planes.
struct V4l2Node::Query {
  Query(const V4l2Node& node, std::uint32_t index) {
    buffer.index = index;
    buffer.type = node.type_;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (!node.multi_planar()) return;
    buffer.m.planes = planes.data();
    buffer.length = static_cast<std::uint32_t>(node.planes_);
  }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;
  v4l2_buffer buffer{};
  std::array<v4l2_plane, VIDEO_MAX_PLANES> planes{};
};

V4l2Node& V4l2Node::operator=(V4l2Node&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(path_, other.path_);
  std::swap(type_, other.type_);
  std::swap(planes_, other.planes_);
  std::swap(buffers_, other.buffers_);
  std::swap(returned_, other.returned_);
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
  if ((can & V4L2_CAP_VIDEO_CAPTURE) != 0)
    node.type_ = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  else if ((can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0)
    node.type_ = V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  if (node.type_ == 0 || (can & V4L2_CAP_STREAMING) == 0)
    return Error{ErrorCode::kDevice,
                 "v4l2:" + path + ": does not stream pictures: try another node"};
  return node;
}

bool V4l2Node::multi_planar() const { return type_ == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE; }

Result<void> V4l2Node::start_streaming(bool lends) {
  v4l2_requestbuffers request{};
  request.count = kNodeBuffers + (lends ? kLentBuffers : 0);
  request.type = type_;
  request.memory = V4L2_MEMORY_MMAP;
  if (ioctl_again(fd_, VIDIOC_REQBUFS, &request) < 0) return failed("requesting buffers");
  buffers_ = std::make_shared<V4l2Buffers>();
  returned_.reserve(request.count);
  for (std::uint32_t i = 0; i < request.count; ++i) MIXRIG_TRY(map_buffer(i, lends));
  if (ioctl_again(fd_, VIDIOC_STREAMON, &type_) < 0) return failed("starting the stream");
  return {};
}

/// Maps every plane of a buffer, exports it if `exports` is set, and queues it.
Result<void> V4l2Node::map_buffer(std::uint32_t index, bool exports) {
  Query query(*this, index);
  if (ioctl_again(fd_, VIDIOC_QUERYBUF, &query.buffer) < 0) return failed("querying a buffer");
  V4l2Buffers::Planes& buffer = buffers_->add();
  for (std::size_t i = 0; i < planes_; ++i) {
    const v4l2_plane& plane = query.planes[i];
    const std::size_t bytes = multi_planar() ? plane.length : query.buffer.length;
    const auto offset = multi_planar() ? plane.m.mem_offset : query.buffer.m.offset;
    void* address = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, offset);
    if (address == MAP_FAILED) return failed("mapping a buffer");
    buffer[i] = {address, bytes};
  }
  if (exports && planes_ == 1) export_buffer(index);
  return queue(index);
}

/// Exports a buffer. If the driver cannot (ENOTTY, EINVAL), its pictures are copied.
void V4l2Node::export_buffer(std::uint32_t index) {
  v4l2_exportbuffer exported{};
  exported.type = type_;
  exported.index = index;
  exported.flags = O_CLOEXEC | O_RDONLY;
  if (ioctl_again(fd_, VIDIOC_EXPBUF, &exported) == 0) buffers_->export_as(exported.fd);
}

Result<void> V4l2Node::queue(std::uint32_t index) {
  Query query(*this, index);
  if (ioctl_again(fd_, VIDIOC_QBUF, &query.buffer) < 0) return failed("queueing a buffer");
  return {};
}

bool V4l2Node::lend(const V4l2Picture& picture, LentPicture& into) {
  if (!buffers_->lend(picture.index, kKeptBuffers)) return false;
  into.buffers = buffers_;
  into.index = picture.index;
  return true;
}

Result<void> V4l2Node::give_back_lent() {
  returned_.clear();
  buffers_->collect(returned_);
  for (const std::uint32_t index : returned_) MIXRIG_TRY(queue(index));
  return {};
}

Result<std::optional<V4l2Picture>> V4l2Node::next(Duration timeout) {
  pollfd poll{fd_, POLLIN, 0};
  const int wait_ms =
      static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(timeout).count());
  const int ready = ::poll(&poll, 1, wait_ms);
  if (ready == 0 || (ready < 0 && errno == EINTR)) return std::optional<V4l2Picture>();
  Query query(*this, 0);
  const v4l2_buffer& buffer = query.buffer;
  if (ioctl_again(fd_, VIDIOC_DQBUF, &query.buffer) < 0) {
    if (errno == EAGAIN) return std::optional<V4l2Picture>();
    return failed("taking a picture");
  }
  if (buffer.index >= buffers_->count())
    return Error{ErrorCode::kDevice, "v4l2:" + path_ + ": the driver returned an unknown buffer"};
  V4l2Picture picture{.index = buffer.index,
                      .sequence = buffer.sequence,
                      .stamp = HostTime(std::chrono::seconds(buffer.timestamp.tv_sec) +
                                        std::chrono::microseconds(buffer.timestamp.tv_usec)),
                      .stamp_valid = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) ==
                                     V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC,
                      .stamp_is_start = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) ==
                                        V4L2_BUF_FLAG_TSTAMP_SRC_SOE,
                      .error = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0};
  for (std::size_t i = 0; i < planes_; ++i) {
    const V4l2Buffers::Mapping& mapping = buffers_->planes(buffer.index)[i];
    // In a multi-planar buffer the used bytes count from its start, the picture begins later.
    const std::size_t used = std::min<std::size_t>(
        multi_planar() ? query.planes[i].bytesused : buffer.bytesused, mapping.bytes);
    const std::size_t begin =
        std::min<std::size_t>(multi_planar() ? query.planes[i].data_offset : 0, used);
    if (i == 0) picture.begin = begin;
    picture.bytes[i] = {static_cast<const std::uint8_t*>(mapping.address) + begin, used - begin};
  }
  return std::optional<V4l2Picture>(picture);
}

void V4l2Node::close() {
  buffers_.reset();
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

}  // namespace mixrig::device
