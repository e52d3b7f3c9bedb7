// SPDX-License-Identifier: Apache-2.0
// A colour picture in its camera's own format, with the tables that make it sRGB. A GPU can read it
// in place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "hal/base/image.h"

namespace mixrig {

/// Memory that other drivers can read in place: a DMABUF of Linux. The maker of the picture owns
/// `fd` and keeps it open while the picture lives.
struct DmaBuf {
  int fd = -1;                   ///< -1: the memory is not shared
  std::size_t offset_bytes = 0;  ///< where the picture begins in the memory
  /// Number of the set of buffers that the memory belongs to, unique in the process: a device that
  /// was opened again has another set.
  std::uint64_t set = 0;
  std::uint32_t index = 0;  ///< of the buffer in its set
  explicit operator bool() const { return fd >= 0; }
};

/// Order of the 8-bit samples in memory.
enum class RawLayout : std::uint8_t {
  kYuyv,   ///< Y0 U Y1 V
  kNv12,   ///< rows of Y, then half as many rows of U V, of the same stride
  kGray,   ///< one sample a pixel
  kBayer,  ///< one sample a pixel; the first red one is at RawPicture::red_x, red_y
};

std::string_view name(RawLayout layout);

/// Integer conversion of 8-bit YUV to R'G'B'. With base = (y * y_scale >> y_shift) + y_add, red is
/// (base + red_v * (v - 128)) >> shift, clamped to 0..255; green and blue likewise. No sum exceeds
/// 31 bits.
struct YuvToRgb {
  int y_scale = 0, y_shift = 0, y_add = 0;
  int red_v = 0, green_u = 0, green_v = 0, blue_u = 0;
  int shift = 0;
};

/// Maps an 8-bit sample to the sRGB byte of red, green or blue light.
using SampleTable = std::array<Rgbx8, 256>;

struct RawPicture {
  RawLayout layout = RawLayout::kGray;
  Size size{};
  std::size_t stride_bytes = 0;  ///< even for kNv12
  std::span<const std::uint8_t> bytes{};
  int red_x = 0, red_y = 0;  ///< 0 or 1
  YuvToRgb yuv{};            ///< used by kYuyv and kNv12 only
  /// Applied to each sample, for YUV to R'G'B'; null: samples are sRGB.
  const SampleTable* samples = nullptr;
  DmaBuf memory{};
};

/// Returns one sRGB pixel, equal to that of the decoder of whole pictures. Precondition: inside the
/// picture.
Rgb8 pixel_of(const RawPicture& picture, int x, int y);

}  // namespace mixrig
