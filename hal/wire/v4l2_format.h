// SPDX-License-Identifier: Apache-2.0
// Which of the modes that a V4L2 node offers to use: pure functions on plain tables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "hal/device/camera.h"

namespace mixrig::device {

/// "YUYV" as the kernel writes it: first letter in the lowest byte.
constexpr std::uint32_t fourcc(char a, char b, char c, char d) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(a)) |
         static_cast<std::uint32_t>(static_cast<unsigned char>(b)) << 8 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << 16 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(d)) << 24;
}
PixelFormat format_of_fourcc(std::uint32_t code);  ///< kUnknown where mixrig does not read it

/// A picture size that a node offers: one size, or a range with steps.
struct V4l2Mode {
  std::uint32_t code = 0;
  Size minimum{}, maximum{}, step{1, 1};
  double max_rate_hz = 0;  ///< 0 where the node does not report it
};

struct V4l2Choice {
  std::uint32_t code = 0;
  PixelFormat format = PixelFormat::kUnknown;
  Size size;
};

/// The offered mode that fits the request best: the requested format and size exactly, where given;
/// else the format by cost and loss (raw before MJPEG), and the largest size up to 1920 x 1200 that
/// keeps the requested rate. Errors: kUnsupported; the line names what is not offered.
Result<V4l2Choice> choose_mode(std::span<const V4l2Mode> modes, const StreamRequest& request);

/// The format that the driver set, after checks.
struct V4l2Layout {
  PixelFormat format = PixelFormat::kUnknown;
  Size size;
  std::size_t stride_bytes = 0;
  std::size_t picture_bytes = 0;  ///< largest payload
};
/// Errors: kDevice where stride or size cannot hold such a picture.
Result<V4l2Layout> checked_layout(std::uint32_t code, std::uint32_t width, std::uint32_t height,
                                  std::uint32_t bytes_per_line, std::uint32_t size_image);

/// Frame flags of a payload of `used` bytes: kFrameIncomplete where it cannot be a whole picture.
std::uint32_t payload_flags(const V4l2Layout& layout, std::size_t used, bool driver_error);

}  // namespace mixrig::device
