// SPDX-License-Identifier: Apache-2.0
// A colour picture as its camera wrote it: where its bytes lie, and how they become sRGB. What a
// GPU needs to read it in place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "hal/base/image.h"

namespace mixrig {

/// Memory that other drivers can read in place: a DMABUF of Linux. Who made the picture owns `fd`,
/// which is open while the picture lives.
struct DmaBuf {
  int fd = -1;                   ///< -1: the memory is not shared
  std::size_t offset_bytes = 0;  ///< of the picture in it
  /// Number of the set of buffers that it belongs to, of the process; never used again: a device
  /// that was opened anew has another set.
  std::uint64_t set = 0;
  std::uint32_t index = 0;  ///< in its set
  explicit operator bool() const { return fd >= 0; }
};

/// Samples of 8 bits.
enum class RawLayout : std::uint8_t {
  kYuyv,   ///< Y0 U Y1 V
  kNv12,   ///< rows of Y, then half as many rows of U V, of the same stride
  kGray,   ///< one sample a pixel
  kBayer,  ///< one sample a pixel; the first red one is at RawPicture::red_x, red_y
};

std::string_view name(RawLayout layout);

/// 8-bit YUV to R'G'B', in whole numbers: base = (y * y_scale >> y_shift) + y_add, then
/// red = (base + red_v * (v - 128)) >> shift, cut to 0..255, and so on. No sum exceeds 31 bits.
struct YuvToRgb {
  int y_scale = 0, y_shift = 0, y_add = 0;
  int red_v = 0, green_u = 0, green_v = 0, blue_u = 0;
  int shift = 0;
};

/// Of 8-bit samples, sRGB bytes of red, green and blue light.
using SampleTable = std::array<Rgbx8, 256>;

struct RawPicture {
  RawLayout layout = RawLayout::kGray;
  Size size{};
  std::size_t stride_bytes = 0;  ///< even for kNv12
  std::span<const std::uint8_t> bytes{};
  int red_x = 0, red_y = 0;              ///< 0 or 1
  YuvToRgb yuv{};                        ///< of kYuyv and kNv12
  const SampleTable* samples = nullptr;  ///< of each sample (of YUV: of R'G'B'); null: as they are
  DmaBuf memory{};
};

/// One pixel, as the decoder of whole pictures makes it. Precondition: inside the picture.
Rgb8 pixel_of(const RawPicture& picture, int x, int y);

}  // namespace mixrig
