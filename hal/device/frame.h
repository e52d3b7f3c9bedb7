// SPDX-License-Identifier: Apache-2.0
// One picture as a driver publishes it: bytes, counter, stamps. Immutable once published.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "hal/base/clock.h"
#include "hal/base/image.h"
#include "hal/base/raw_picture.h"

namespace mixrig::device {

/// Layout of the bytes of a frame. Multi-byte samples are little-endian.
enum class PixelFormat {
  kUnknown,
  kRgb8,   ///< R G B
  kBgr8,   ///< B G R
  kYuyv,   ///< Y0 U Y1 V, two pixels in four bytes
  kNv12,   ///< plane of Y, then a half-size plane of U V
  kMjpeg,  ///< one JPEG file
  kGray8,
  kGray16,      ///< full scale is 65535, whatever the sensor's bits
  kBayerRggb8,  ///< names of Bayer formats give the first two rows
  kBayerGrbg8,
  kBayerGbrg8,
  kBayerBggr8,
  kDepth16,      ///< 16-bit depth steps, see DepthInfo
  kBayerRggb16,  ///< full scale is 65535, whatever the sensor's bits
  kBayerGrbg16,
  kBayerGbrg16,
  kBayerBggr16,
};
inline constexpr int kPixelFormats = 17;

std::string_view name(PixelFormat format);
/// Bytes of one row of `width` pixels (first plane); 0 for kMjpeg and kUnknown.
std::size_t row_bytes(PixelFormat format, int width);
/// Bytes of a whole picture with rows of `stride` bytes; 0 for kMjpeg and kUnknown.
std::size_t image_bytes(PixelFormat format, Size size, std::size_t stride);

/// Known defects of a frame, as a bit mask.
enum FrameFlag : std::uint32_t {
  kFrameOk = 0,
  kFrameIncomplete =
      1U << 0,               ///< bytes are missing, or the device reports it: do not use the pixels
  kFrameAfterGap = 1U << 1,  ///< frames before it were lost (counter jumped)
  kFrameRestarted = 1U << 2,  ///< first frame after the device was reopened: its counter restarted
};

struct Frame {
  PixelFormat format = PixelFormat::kUnknown;
  Size size{};
  std::size_t stride_bytes = 0;
  std::span<const std::uint8_t> bytes{};  ///< the picture; for kMjpeg a whole file
  std::span<const std::uint8_t>
      amplitude{};  ///< ToF: 16-bit amplitudes, same size and packed; or empty
  /// Depth only: 16-bit confidence, same size and packed; or empty.
  std::span<const std::uint8_t> confidence{};
  std::uint64_t sequence = 0;  ///< the device's counter
  DeviceTime device_time{};    ///< mid-exposure, on the device's clock
  HostTime received{};         ///< when the driver received it
  Duration exposure{};         ///< 0 where unknown
  std::uint32_t flags = kFrameOk;
  DmaBuf memory{};  ///< shared memory that holds `bytes` (StreamRequest::lends)
};

/// Dropping the last reference returns the buffer to its pool.
using FramePtr = std::shared_ptr<const Frame>;

/// Receives frames on the driver's thread, in order. Must not block and must not throw.
using FrameSink = std::function<void(const FramePtr&)>;

}  // namespace mixrig::device
