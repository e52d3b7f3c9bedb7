// SPDX-License-Identifier: Apache-2.0
// Parts of the libcamera driver: the library's manager, mapped buffers, formats. Private to this
// module.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <libcamera/camera_manager.h>
#include <libcamera/framebuffer.h>
#include <libcamera/stream.h>
#include <sys/mman.h>

#include "hal/base/result.h"
#include "hal/device/camera.h"
#include "hal/wire/camera/v4l2_format.h"

namespace mixrig::device {

namespace lc = libcamera;

/// The library's manager. The library allows one in a process; it lives while a camera is open.
/// Errors: kIo.
Result<std::shared_ptr<lc::CameraManager>> libcamera_manager();

/// Maps the whole memory of a frame buffer; its planes are parts of it.
class MappedBuffer {
 public:
  static std::optional<MappedBuffer> map(const lc::FrameBuffer& buffer) {
    MappedBuffer mapped;
    for (const lc::FrameBuffer::Plane& plane : buffer.planes()) {
      if (mapped.count_ == kMostV4l2Planes) return std::nullopt;
      const std::size_t bytes = std::size_t{plane.offset} + plane.length;
      void* at = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
      if (at == MAP_FAILED) return std::nullopt;
      mapped.maps_[mapped.count_] = {static_cast<const std::uint8_t*>(at), bytes};
      mapped.planes_[mapped.count_] = mapped.maps_[mapped.count_].subspan(plane.offset);
      ++mapped.count_;
    }
    return mapped;
  }
  MappedBuffer(MappedBuffer&& other) noexcept
      : maps_(other.maps_), planes_(other.planes_), count_(std::exchange(other.count_, 0)) {}
  MappedBuffer& operator=(MappedBuffer&&) = delete;
  ~MappedBuffer() {
    for (std::size_t i = 0; i < count_; ++i)
      ::munmap(const_cast<std::uint8_t*>(maps_[i].data()), maps_[i].size());
  }
  /// The first bytes of each plane, as many as were filled.
  V4l2Bytes filled(lc::Span<const lc::FrameMetadata::Plane> used) const {
    V4l2Bytes bytes;
    for (std::size_t i = 0; i < std::min(count_, used.size()); ++i)
      bytes[i] = planes_[i].first(std::min<std::size_t>(planes_[i].size(), used[i].bytesused));
    return bytes;
  }

 private:
  MappedBuffer() = default;
  V4l2Bytes maps_, planes_;
  std::size_t count_ = 0;
};

/// Colour encoding of the stream's samples; sRGB and BT.601 where the camera does not report it.
ColorEncoding libcamera_encoding(const std::optional<lc::ColorSpace>& space);
/// Modes in formats that mixrig reads, by their V4L2 codes, in the sizes that the library lists.
/// With `any_size` also in sizes between, which the camera may or may not deliver.
std::vector<V4l2Mode> libcamera_modes(const lc::StreamFormats& formats, bool any_size);

}  // namespace mixrig::device
