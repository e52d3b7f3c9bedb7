// SPDX-License-Identifier: Apache-2.0
// Chooses among the modes that a V4L2 node offers, and copies its pictures: pure functions on plain
// tables.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "hal/device/camera.h"
#include "hal/wire/camera/packed_samples.h"

namespace mixrig::device {

/// Returns a format code as the kernel writes it: the first letter in the lowest byte.
constexpr std::uint32_t fourcc(char a, char b, char c, char d) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(a)) |
         static_cast<std::uint32_t>(static_cast<unsigned char>(b)) << 8 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << 16 |
         static_cast<std::uint32_t>(static_cast<unsigned char>(d)) << 24;
}
PixelFormat format_of_fourcc(std::uint32_t code);  ///< kUnknown if mixrig does not read it

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

/// Returns the offered mode that fits the request best. A requested format or size must match
/// exactly. Else the format is chosen by cost and loss (raw before MJPEG), and the size is the
/// largest up to 1920 x 1200 that keeps the requested rate. Errors: kUnsupported; the line names
/// what is not offered.
Result<V4l2Choice> choose_mode(std::span<const V4l2Mode> modes, const StreamRequest& request);

/// Size of one plane of a driver's buffers: `bytesperline` and `sizeimage`.
struct V4l2Plane {
  std::uint32_t stride_bytes = 0, bytes = 0;
};
inline constexpr std::size_t kMostV4l2Planes = 2;

/// The format that the driver set, after checks: layout of its buffers and of the frames made from
/// them.
struct V4l2Layout {
  PixelFormat format = PixelFormat::kUnknown;
  Size size;
  std::size_t stride_bytes = 0;   ///< of a frame
  std::size_t picture_bytes = 0;  ///< largest size of a frame
  int sample_bits = 8;
  /// Packing of the driver's only plane; kNone where frames have the same bytes.
  PackedSamples packed;
  std::size_t planes = 1;
  std::array<std::size_t, kMostV4l2Planes> plane_stride_bytes{}, plane_bytes{};  ///< by plane
};
/// Checks the format that a driver set. `planes` describes the driver's buffers, 1 or 2. Errors:
/// kDevice where they cannot hold such a picture.
Result<V4l2Layout> checked_layout(std::uint32_t code, std::uint32_t width, std::uint32_t height,
                                  std::span<const V4l2Plane> planes);

/// The bytes of one filled buffer, a span for each plane.
using V4l2Bytes = std::array<std::span<const std::uint8_t>, kMostV4l2Planes>;
/// Returns the frame flags of a filled buffer: kFrameIncomplete if it cannot be a whole picture.
std::uint32_t payload_flags(const V4l2Layout& layout, const V4l2Bytes& bytes, bool driver_error);
/// Writes the bytes of a frame: samples unpacked, planes one after the other. Returns the number of
/// bytes, which is below picture_bytes for an incomplete buffer. Precondition: `out` holds
/// picture_bytes.
std::size_t copy_v4l2_picture(const V4l2Layout& layout, const V4l2Bytes& bytes,
                              std::span<std::uint8_t> out);

/// Colorimetry as the driver reports it, with the numbers of linux/videodev2.h; 0: its default.
struct V4l2Colors {
  std::uint32_t colorspace = 0, ycbcr = 0, quantization = 0, transfer = 0;
};
/// Converts the driver's colorimetry by the kernel's rules for defaults; a driver that reports
/// nothing sends sRGB and BT.601. A transfer that ColorEncoding does not have becomes the nearest
/// one (SMPTE 240M: BT.709, opRGB: gamma 2.2, DCI-P3: gamma 2.6, SMPTE 2084: sRGB).
ColorEncoding encoding_of(const V4l2Colors& colors);

/// Returns the metres per Z16 step by the camera's USB id; empty if its maker has not published it.
std::optional<double> z16_metres_per_step(std::uint16_t usb_vendor, std::uint16_t usb_product);

}  // namespace mixrig::device
