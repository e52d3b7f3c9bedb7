// SPDX-License-Identifier: Apache-2.0
#include "host/rig/decode.h"

#include <algorithm>
#include <array>

#include "host/image_io/image_io.h"

namespace mixrig::rig {
namespace {

using device::Frame;
using device::PixelFormat;

std::uint8_t clip(int value) { return static_cast<std::uint8_t>(std::clamp(value, 0, 255)); }

/// BT.601, limited range, 8 fractional bits.
Rgb8 from_yuv(int y, int u, int v) {
  const int c = 298 * (y - 16), d = u - 128, e = v - 128;
  return {clip((c + 409 * e + 128) >> 8), clip((c - 100 * d - 208 * e + 128) >> 8),
          clip((c + 516 * d + 128) >> 8)};
}

const std::uint8_t* row_of(const Frame& frame, int y) {
  return frame.bytes.data() + static_cast<std::size_t>(y) * frame.stride_bytes;
}

void decode_yuyv(const Frame& frame, Image<Rgb8>& out) {
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* in = row_of(frame, y);
    Rgb8* row = out.row(y);
    for (int x = 0; x < frame.size.width; ++x) {
      const std::uint8_t* pair = in + 4 * (x / 2);
      row[x] = from_yuv(pair[2 * (x % 2)], pair[1], pair[3]);
    }
  }
}

void decode_nv12(const Frame& frame, Image<Rgb8>& out) {
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* luma = row_of(frame, y);
    const std::uint8_t* chroma = row_of(frame, frame.size.height + y / 2);
    Rgb8* row = out.row(y);
    for (int x = 0; x < frame.size.width; ++x)
      row[x] = from_yuv(luma[x], chroma[x / 2 * 2],
                        chroma[std::min(x / 2 * 2 + 1, frame.size.width - 1)]);
  }
}

void decode_packed(const Frame& frame, int red, int blue, Image<Rgb8>& out) {
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* in = row_of(frame, y);
    for (int x = 0; x < frame.size.width; ++x, in += 3) out.row(y)[x] = {in[red], in[1], in[blue]};
  }
}

void decode_gray(const Frame& frame, int bytes, Image<Rgb8>& out) {
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* in = row_of(frame, y) + (bytes - 1);
    for (int x = 0; x < frame.size.width; ++x, in += bytes) out.row(y)[x] = {*in, *in, *in};
  }
}

/// Mean of the neighbours of a colour within one pixel; `red_x`, `red_y` place the first red one.
void decode_bayer(const Frame& frame, int red_x, int red_y, Image<Rgb8>& out) {
  const int width = frame.size.width, height = frame.size.height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::array<int, 3> sum{}, count{};
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
          const bool red_row = (v - red_y) % 2 == 0, red_column = (u - red_x) % 2 == 0;
          const auto color = static_cast<std::size_t>(red_row != red_column ? 1 : red_row ? 0 : 2);
          sum[color] += row_of(frame, v)[u];
          ++count[color];
        }
      }
      const bool red_row = (y - red_y) % 2 == 0, red_column = (x - red_x) % 2 == 0;
      const auto own = static_cast<std::size_t>(red_row != red_column ? 1 : red_row ? 0 : 2);
      std::array<std::uint8_t, 3> rgb{};
      for (std::size_t c = 0; c < 3; ++c)
        rgb[c] = static_cast<std::uint8_t>(sum[c] / std::max(1, count[c]));
      rgb[own] = row_of(frame, y)[x];
      out.row(y)[x] = {rgb[0], rgb[1], rgb[2]};
    }
  }
}

}  // namespace

Result<void> decode_rgb8(const Frame& frame, Image<Rgb8>& out) {
  if (frame.format == PixelFormat::kMjpeg)
    return image_io::decode_rgb8(frame.bytes.data(), frame.bytes.size(), "camera picture", out);
  const std::size_t row = device::row_bytes(frame.format, frame.size.width);
  const std::size_t whole = device::image_bytes(frame.format, frame.size, frame.stride_bytes);
  if (row == 0 || frame.stride_bytes < row || whole == 0 ||
      frame.bytes.size() + frame.stride_bytes < whole + row)
    return Error{ErrorCode::kData, "a camera picture is shorter than its size says: dropped"};
  if (out.size() != frame.size) out.reset(frame.size);
  switch (frame.format) {
    case PixelFormat::kRgb8:
      return decode_packed(frame, 0, 2, out), Result<void>();
    case PixelFormat::kBgr8:
      return decode_packed(frame, 2, 0, out), Result<void>();
    case PixelFormat::kYuyv:
      return decode_yuyv(frame, out), Result<void>();
    case PixelFormat::kNv12:
      return decode_nv12(frame, out), Result<void>();
    case PixelFormat::kGray8:
      return decode_gray(frame, 1, out), Result<void>();
    case PixelFormat::kGray16:
      return decode_gray(frame, 2, out), Result<void>();
    case PixelFormat::kBayerRggb8:
      return decode_bayer(frame, 0, 0, out), Result<void>();
    case PixelFormat::kBayerGrbg8:
      return decode_bayer(frame, 1, 0, out), Result<void>();
    case PixelFormat::kBayerGbrg8:
      return decode_bayer(frame, 0, 1, out), Result<void>();
    case PixelFormat::kBayerBggr8:
      return decode_bayer(frame, 1, 1, out), Result<void>();
    default:
      return Error{ErrorCode::kData, "a camera sends " + std::string(device::name(frame.format)) +
                                         ", which has no colours"};
  }
}

}  // namespace mixrig::rig
