// SPDX-License-Identifier: Apache-2.0
#include "host/capture/decode.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <libyuv.h>

#include "host/image_io/image_io.h"

namespace mixrig::capture {
namespace {

using device::Frame;
using device::PixelFormat;

const std::uint8_t* row_of(const Frame& frame, int y) {
  return frame.bytes.data() + static_cast<std::size_t>(y) * frame.stride_bytes;
}

int stride_bytes(const Image<Rgb8>& image) { return static_cast<int>(image.stride()) * 3; }
std::uint8_t* bytes_of(Rgb8* pixels) { return reinterpret_cast<std::uint8_t*>(pixels); }

/// libyuv converts to packed RGB through four bytes a pixel; short blocks stay in the cache.
void decode_yuyv(const Frame& frame, Image<Rgb8>& out) {
  constexpr int kBlock_px = 1024;
  std::array<std::uint8_t, 4 * kBlock_px> argb;
  for (int y = 0; y < frame.size.height; ++y)
    for (int x = 0; x < frame.size.width; x += kBlock_px) {
      const int count = std::min(kBlock_px, frame.size.width - x);
      libyuv::YUY2ToARGB(row_of(frame, y) + 2 * x, 0, argb.data(), 0, count, 1);
      libyuv::ARGBToRAW(argb.data(), 0, bytes_of(out.row(y) + x), 0, count, 1);
    }
}

void decode_nv12(const Frame& frame, Image<Rgb8>& out) {
  const auto stride = static_cast<int>(frame.stride_bytes);
  libyuv::NV12ToRAW(row_of(frame, 0), stride, row_of(frame, frame.size.height), stride,
                    bytes_of(out.row(0)), stride_bytes(out), frame.size.width, frame.size.height);
}

void decode_rgb(const Frame& frame, Image<Rgb8>& out) {
  for (int y = 0; y < frame.size.height; ++y)
    std::memcpy(out.row(y), row_of(frame, y), 3 * static_cast<std::size_t>(frame.size.width));
}

void decode_bgr(const Frame& frame, Image<Rgb8>& out) {
  libyuv::RAWToRGB24(row_of(frame, 0), static_cast<int>(frame.stride_bytes), bytes_of(out.row(0)),
                     stride_bytes(out), frame.size.width, frame.size.height);
}

void decode_gray(const Frame& frame, int bytes, Image<Rgb8>& out) {
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* in = row_of(frame, y) + (bytes - 1);
    for (int x = 0; x < frame.size.width; ++x, in += bytes) out.row(y)[x] = {*in, *in, *in};
  }
}

/// Each missing colour is the mean of its samples among the 8 neighbours; the first red sample is
/// at (`red_x`, `red_y`).
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
  // Chroma of NV12 comes in pairs of bytes.
  const int samples =
      frame.size.width + (frame.format == PixelFormat::kNv12 ? frame.size.width % 2 : 0);
  const std::size_t row = device::row_bytes(frame.format, samples);
  const std::size_t whole = device::image_bytes(frame.format, frame.size, frame.stride_bytes);
  if (row == 0 || frame.stride_bytes < row || whole == 0 ||
      frame.bytes.size() + frame.stride_bytes < whole + row)
    return Error{ErrorCode::kData, "a camera picture is shorter than its size says: dropped"};
  if (out.size() != frame.size) out.reset(frame.size);
  switch (frame.format) {
    case PixelFormat::kRgb8:
      return decode_rgb(frame, out), Result<void>();
    case PixelFormat::kBgr8:
      return decode_bgr(frame, out), Result<void>();
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
                                         ", which has no colour"};
  }
}

}  // namespace mixrig::capture
