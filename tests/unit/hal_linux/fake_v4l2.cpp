// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/hal_linux/fake_v4l2.h"

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace mixrig::test {
namespace {

constexpr std::uint32_t kPlaneRoom = 1 << 16;

FakeV4l2* g_node = nullptr;

int fail(int reason) {
  errno = reason;
  return -1;
}

template <typename T>
T& as(void* argument) {
  return *static_cast<T*>(argument);
}

}  // namespace

FakeV4l2::FakeV4l2() {
  std::string name = std::filesystem::temp_directory_path() / "mixrig_v4l2_XXXXXX";
  fd_ = ::mkstemp(name.data());
  path_ = name;
  if (::ftruncate(fd_, static_cast<off_t>(kPlaneRoom) * kRoom * VIDEO_MAX_PLANES) != 0)
    std::abort();
  g_node = this;
}

FakeV4l2::~FakeV4l2() {
  g_node = nullptr;
  ::close(fd_);
  std::filesystem::remove(path_);
}

bool FakeV4l2::is(int fd) const {
  struct stat own {
  }, other{};
  return ::fstat(fd_, &own) == 0 && ::fstat(fd, &other) == 0 && own.st_ino == other.st_ino &&
         own.st_dev == other.st_dev;
}

std::uint32_t FakeV4l2::type() const {
  return multi_planar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

std::uint32_t FakeV4l2::offset(std::uint32_t buffer, std::size_t plane) const {
  return (buffer * VIDEO_MAX_PLANES + static_cast<std::uint32_t>(plane)) * kPlaneRoom;
}

int FakeV4l2::describe(v4l2_capability& capability) const {
  std::strcpy(reinterpret_cast<char*>(capability.card), "fake");
  const std::uint32_t usual =
      V4L2_CAP_STREAMING | (multi_planar ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE);
  capability.device_caps = capabilities != 0 ? capabilities : usual;
  capability.capabilities = capability.device_caps | V4L2_CAP_DEVICE_CAPS;
  return 0;
}

int FakeV4l2::set_format(v4l2_format& format) const {
  if (format.type != type()) return fail(EINVAL);
  const auto fill = [&](auto& pix) {
    pix.width = static_cast<std::uint32_t>(size.width);
    pix.height = static_cast<std::uint32_t>(size.height);
    pix.pixelformat = code;
    pix.colorspace = colorspace;
    pix.quantization = static_cast<std::uint8_t>(quantization);
    pix.xfer_func = static_cast<std::uint8_t>(transfer);
    pix.ycbcr_enc = static_cast<std::uint8_t>(ycbcr);
  };
  if (!multi_planar) {
    auto& pix = format.fmt.pix;
    fill(pix);
    pix.priv = V4L2_PIX_FMT_PRIV_MAGIC;
    pix.bytesperline = planes[0].stride_bytes;
    pix.sizeimage = planes[0].bytes;
    return 0;
  }
  auto& pix = format.fmt.pix_mp;
  fill(pix);
  pix.num_planes = static_cast<std::uint8_t>(planes.size());
  for (std::size_t i = 0; i < planes.size(); ++i) {
    pix.plane_fmt[i].bytesperline = planes[i].stride_bytes;
    pix.plane_fmt[i].sizeimage = planes[i].bytes;
  }
  return 0;
}

int FakeV4l2::query(v4l2_buffer& buffer) const {
  if (buffer.type != type() || buffer.index >= buffers_) return fail(EINVAL);
  if (!multi_planar) {
    buffer.length = kPlaneRoom;
    buffer.m.offset = offset(buffer.index, 0);
    return 0;
  }
  if (buffer.m.planes == nullptr || buffer.length < planes.size()) return fail(EINVAL);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    buffer.m.planes[i].length = kPlaneRoom;
    buffer.m.planes[i].m.mem_offset = offset(buffer.index, i);
  }
  return 0;
}

int FakeV4l2::queue(const v4l2_buffer& buffer) {
  if (buffer.type != type() || buffer.index >= buffers_) return fail(EINVAL);
  if (multi_planar && (buffer.m.planes == nullptr || buffer.length < planes.size()))
    return fail(EINVAL);
  const std::lock_guard lock(mutex_);
  queued_.push_back(buffer.index);
  return 0;
}

std::size_t FakeV4l2::queued() const {
  const std::lock_guard lock(mutex_);
  return queued_.size();
}

int FakeV4l2::export_buffer(v4l2_exportbuffer& buffer) const {
  if (!exports) return fail(ENOTTY);
  if (buffer.type != type() || buffer.index >= buffers_) return fail(EINVAL);
  buffer.fd = ::fcntl(fd_, F_DUPFD_CLOEXEC, 0);
  return 0;
}

int FakeV4l2::dequeue(v4l2_buffer& buffer) {
  if (buffer.type != type()) return fail(EINVAL);
  if (unplug_after >= 0 && sequence_ == static_cast<std::uint32_t>(unplug_after)) {
    unplug_after = -1;
    absent_ = absent_for;
    return fail(ENODEV);
  }
  const std::lock_guard lock(mutex_);
  if (pictures.empty() || queued_.empty()) return fail(EAGAIN);
  buffer.index = queued_.front();
  queued_.pop_front();
  buffer.sequence = sequence_++;
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  for (std::size_t i = 0; i < pictures.front().size(); ++i) {
    const auto& bytes = pictures.front()[i];
    const std::uint32_t begin = multi_planar ? planes[i].data_offset : 0;
    const off_t at = offset(buffer.index, i) + begin;
    if (::pwrite(fd_, bytes.data(), bytes.size(), at) != static_cast<ssize_t>(bytes.size()))
      std::abort();
    const auto used = static_cast<std::uint32_t>(bytes.size()) + begin;
    if (!multi_planar) {
      buffer.bytesused = used;
      continue;
    }
    buffer.m.planes[i].bytesused = used;
    buffer.m.planes[i].data_offset = begin;
  }
  pictures.pop_front();
  return 0;
}

int FakeV4l2::extend(const uvc_xu_control_query& query) {
  if (extension_answer.empty() || query.unit != 3 || query.selector != 1) return fail(ENOENT);
  if (query.size != extension_answer.size()) return fail(ENOBUFS);
  if (query.query == UVC_SET_CUR) {
    extension_request.assign(query.data, query.data + query.size);
    return 0;
  }
  if (query.query != UVC_GET_CUR || extension_request.empty()) return fail(EINVAL);
  std::copy(extension_answer.begin(), extension_answer.end(), query.data);
  return 0;
}

int FakeV4l2::ioctl(unsigned long request, void* argument) {
  if (absent_ > 0) {
    if (request == VIDIOC_QUERYCAP && --absent_ == 0) sequence_ = 0;
    return fail(ENODEV);
  }
  switch (request) {
    case VIDIOC_QUERYCAP:
      return describe(as<v4l2_capability>(argument));
    case VIDIOC_ENUM_FMT: {
      auto& description = as<v4l2_fmtdesc>(argument);
      if (description.index > 0 || description.type != type()) return fail(EINVAL);
      return description.pixelformat = code, 0;
    }
    case VIDIOC_ENUM_FRAMESIZES: {
      auto& entry = as<v4l2_frmsizeenum>(argument);
      if (entry.index > 0) return fail(EINVAL);
      entry.type = V4L2_FRMSIZE_TYPE_DISCRETE;
      entry.discrete = {static_cast<std::uint32_t>(size.width),
                        static_cast<std::uint32_t>(size.height)};
      return 0;
    }
    case VIDIOC_S_FMT:
      return set_format(as<v4l2_format>(argument));
    case VIDIOC_G_PARM:
      return as<v4l2_streamparm>(argument).type == type() ? 0 : fail(EINVAL);
    case VIDIOC_REQBUFS:
      if (as<v4l2_requestbuffers>(argument).type != type()) return fail(EINVAL);
      queued_.clear();
      buffers_ = std::min({as<v4l2_requestbuffers>(argument).count, most_buffers, kRoom});
      return as<v4l2_requestbuffers>(argument).count = buffers_, 0;
    case VIDIOC_EXPBUF:
      return export_buffer(as<v4l2_exportbuffer>(argument));
    case VIDIOC_QUERYBUF:
      return query(as<v4l2_buffer>(argument));
    case VIDIOC_QBUF:
      return queue(as<v4l2_buffer>(argument));
    case VIDIOC_DQBUF:
      return dequeue(as<v4l2_buffer>(argument));
    case VIDIOC_STREAMON:
      return as<std::uint32_t>(argument) == type() ? 0 : fail(EINVAL);
    case UVCIOC_CTRL_QUERY:
      return extend(as<uvc_xu_control_query>(argument));
    default:
      return fail(ENOTTY);
  }
}

}  // namespace mixrig::test

/// Takes the place of libc's for the whole program.
extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  using mixrig::test::g_node;
  if (g_node != nullptr && g_node->is(fd)) return g_node->ioctl(request, argument);
  return static_cast<int>(::syscall(SYS_ioctl, fd, request, argument));
}
