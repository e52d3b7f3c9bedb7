// SPDX-License-Identifier: Apache-2.0
// A V4L2 node without a kernel: a regular file, and this program's own ioctl() in place of libc's.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include <linux/usb/video.h>
#include <linux/uvcvideo.h>
#include <linux/videodev2.h>

#include "hal/base/image.h"

namespace mixrig::test {

struct FakePlane {
  std::uint32_t stride_bytes = 0, bytes = 0;
  std::uint32_t data_offset = 0;  ///< of a multi-planar node: where the picture begins
};

/// A node that sends one format and size. Buffers lie in a file, which the driver under test maps;
/// ioctl() on it is answered as Documentation/userspace-api/media/v4l of the kernel says. Only one
/// may exist at a time.
class FakeV4l2 {
 public:
  FakeV4l2();
  ~FakeV4l2();
  FakeV4l2(const FakeV4l2&) = delete;
  FakeV4l2& operator=(const FakeV4l2&) = delete;

  const std::string& path() const { return path_; }
  int ioctl(unsigned long request, void* argument);
  bool is(int fd) const;

  bool multi_planar = false;
  std::uint32_t capabilities = 0;  ///< 0: those that multi_planar implies
  std::uint32_t code = 0;
  Size size{};
  std::vector<FakePlane> planes;
  /// Last request to extension unit 3, selector 1, and its answer; no such unit exists while the
  /// answer is empty.
  std::vector<std::uint8_t> extension_request, extension_answer;
  std::uint32_t colorspace = 0, ycbcr = 0, quantization = 0, transfer = 0;
  /// Bytes of each plane of the pictures to send.
  std::deque<std::vector<std::vector<std::uint8_t>>> pictures;
  std::uint32_t most_buffers = 4;  ///< upper limit of the buffers granted; kRoom limits too
  bool exports = false;            ///< VIDIOC_EXPBUF returns descriptors of the whole file
  /// Number of buffers that the driver has queued, filled or not. Thread-safe.
  std::size_t queued() const;
  /// The node is unplugged after `unplug_after` pictures (-1: never) and stays away for
  /// `absent_for` attempts to find it.
  int unplug_after = -1, absent_for = 0;

 private:
  int extend(const uvc_xu_control_query& query);
  std::uint32_t type() const;
  int describe(v4l2_capability& capability) const;
  int set_format(v4l2_format& format) const;
  int query(v4l2_buffer& buffer) const;
  int queue(const v4l2_buffer& buffer);
  int dequeue(v4l2_buffer& buffer);
  std::uint32_t offset(std::uint32_t buffer, std::size_t plane) const;

  std::string path_;
  int fd_ = -1;
  static constexpr std::uint32_t kRoom = 12;
  int export_buffer(v4l2_exportbuffer& buffer) const;

  mutable std::mutex mutex_;  ///< guards queued_
  std::uint32_t buffers_ = 0;
  std::deque<std::uint32_t> queued_;
  std::uint32_t sequence_ = 0;
  int absent_ = 0;
};

}  // namespace mixrig::test
