// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/yuv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <libyuv.h>

namespace mixrig::capture {
namespace {

using device::ColorEncoding;
using device::Frame;
using device::SampleRange;
using device::YuvMatrix;

constexpr int kBlock_px = 1024;  // short blocks stay in the cache

const std::uint8_t* yuv_row(const Frame& frame, int y) {
  return frame.bytes.data() + static_cast<std::size_t>(y) * frame.stride_bytes;
}
std::uint8_t* rgb_bytes(Rgb8* pixels) { return reinterpret_cast<std::uint8_t*>(pixels); }

/// Returns libyuv's constants. They only hold blue factors up to 2: those of limited BT.709 (2.112)
/// and BT.2020 (2.142) would be up to 18 of 255 off.
const libyuv::YuvConstants& constants(const ColorEncoding& encoding) {
  const bool full = encoding.range == SampleRange::kFull;
  switch (encoding.matrix) {
    case YuvMatrix::kBt709:
      return full ? libyuv::kYuvF709Constants : libyuv::kYuvH709Constants;
    case YuvMatrix::kBt2020:
      return full ? libyuv::kYuvV2020Constants : libyuv::kYuv2020Constants;
    default:
      return full ? libyuv::kYuvJPEGConstants : libyuv::kYuvI601Constants;
  }
}
bool libyuv_holds(const ColorEncoding& encoding) {
  return encoding.matrix == YuvMatrix::kBt601 || encoding.range == SampleRange::kFull;
}

/// Factors of R' = luma (y - 16) + red_v (v - 128) and so on, in 1/65536.
struct Factors {
  int luma, red_v, green_u, green_v, blue_u;
};
/// Returns the factors of limited range from the luma coefficients of red and blue (ITU-R BT.709-6,
/// BT.2020-2).
Factors limited_factors(double kr, double kb) {
  const auto fixed = [](double value) { return static_cast<int>(std::lround(value * 65536)); };
  const double chroma = 255.0 / 112, kg = 1 - kr - kb;
  return {fixed(255.0 / 219), fixed(chroma * (1 - kr)), fixed(-chroma * (1 - kb) * kb / kg),
          fixed(-chroma * (1 - kr) * kr / kg), fixed(chroma * (1 - kb))};
}

Factors limited_factors(YuvMatrix matrix) {
  return matrix == YuvMatrix::kBt2020 ? limited_factors(0.2627, 0.0593)
                                      : limited_factors(0.2126, 0.0722);
}

/// libyuv's numbers, in 1/64 (its source/row_common.cc): luma is y * 257 * scale / 65536.
struct YuvNumbers {
  int scale, add, red_v, green_u, green_v, blue_u;
};
YuvNumbers numbers_of(const ColorEncoding& encoding) {
  if (encoding.range != SampleRange::kFull) return {18997, -1160, 102, -25, -52, 128};
  switch (encoding.matrix) {
    case YuvMatrix::kBt709:
      return {16320, 32, 101, -12, -30, 119};
    case YuvMatrix::kBt2020:
      return {16320, 32, 94, -11, -37, 120};
    default:
      return {16320, 32, 90, -22, -46, 113};
  }
}

/// A block of pixels as planes; chroma has half the width.
struct Block {
  std::array<std::uint8_t, kBlock_px> y;
  std::array<std::uint8_t, kBlock_px / 2> u, v;
};

std::uint8_t clamped(int fixed) {
  return static_cast<std::uint8_t>(std::clamp((fixed + 32768) >> 16, 0, 255));
}

/// Converts a block in loops that compilers vectorise.
void convert(const Block& block, const Factors& f, int count, Rgb8* out) {
  std::array<int, kBlock_px> u, v;
  for (int i = 0; i < (count + 1) / 2; ++i) {
    const auto at = static_cast<std::size_t>(i);
    u[2 * at] = u[2 * at + 1] = block.u[at] - 128;
    v[2 * at] = v[2 * at + 1] = block.v[at] - 128;
  }
  std::array<std::uint8_t, kBlock_px> red, green, blue;
  for (std::size_t x = 0; x < static_cast<std::size_t>(count); ++x) {
    const int luma = f.luma * (block.y[x] - 16);
    red[x] = clamped(luma + f.red_v * v[x]);
    green[x] = clamped(luma + f.green_u * u[x] + f.green_v * v[x]);
    blue[x] = clamped(luma + f.blue_u * u[x]);
  }
  libyuv::MergeRGBPlane(red.data(), 0, green.data(), 0, blue.data(), 0, rgb_bytes(out), 0, count,
                        1);
}

void convert_by_libyuv(const Block& block, const ColorEncoding& encoding, int count, Rgb8* out) {
  std::array<std::uint8_t, 4 * kBlock_px> argb;
  libyuv::I422ToARGBMatrix(block.y.data(), 0, block.u.data(), 0, block.v.data(), 0, argb.data(), 0,
                           &constants(encoding), count, 1);
  libyuv::ARGBToRAW(argb.data(), 0, rgb_bytes(out), 0, count, 1);
}

/// Decodes the usual YUYV of webcams directly, without planes.
void decode_usual_yuyv(const Frame& frame, Image<Rgb8>& out) {
  std::array<std::uint8_t, 4 * kBlock_px> argb;
  for (int y = 0; y < frame.size.height; ++y)
    for (int x = 0; x < frame.size.width; x += kBlock_px) {
      const int count = std::min(kBlock_px, frame.size.width - x);
      libyuv::YUY2ToARGB(yuv_row(frame, y) + 2 * x, 0, argb.data(), 0, count, 1);
      libyuv::ARGBToRAW(argb.data(), 0, rgb_bytes(out.row(y) + x), 0, count, 1);
    }
}

/// Converts a picture block by block. `load(x, y, count, block)` splits pixels x to x + count of
/// row y into planes.
template <typename Load>
void convert_rows(Size size, const ColorEncoding& encoding, const Load& load, Image<Rgb8>& out) {
  const Factors factors = limited_factors(encoding.matrix);
  Block block;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; x += kBlock_px) {
      const int count = std::min(kBlock_px, size.width - x);
      load(x, y, count, block);
      if (libyuv_holds(encoding))
        convert_by_libyuv(block, encoding, count, out.row(y) + x);
      else
        convert(block, factors, count, out.row(y) + x);
    }
}

}  // namespace

YuvToRgb yuv_to_rgb(const ColorEncoding& encoding) {
  if (libyuv_holds(encoding)) {
    const YuvNumbers n = numbers_of(encoding);
    return {.y_scale = 257 * n.scale,
            .y_shift = 16,
            .y_add = n.add,
            .red_v = n.red_v,
            .green_u = n.green_u,
            .green_v = n.green_v,
            .blue_u = n.blue_u,
            .shift = 6};
  }
  const Factors f = limited_factors(encoding.matrix);
  return {.y_scale = f.luma,
          .y_shift = 0,
          .y_add = 32768 - 16 * f.luma,
          .red_v = f.red_v,
          .green_u = f.green_u,
          .green_v = f.green_v,
          .blue_u = f.blue_u,
          .shift = 16};
}

void decode_yuyv(const Frame& frame, const ColorEncoding& encoding, Image<Rgb8>& out) {
  if (encoding.matrix == YuvMatrix::kBt601 && encoding.range != SampleRange::kFull)
    return decode_usual_yuyv(frame, out);
  const auto load = [&](int x, int y, int count, Block& block) {
    libyuv::YUY2ToI422(yuv_row(frame, y) + 2 * x, 0, block.y.data(), 0, block.u.data(), 0,
                       block.v.data(), 0, count, 1);
  };
  convert_rows(frame.size, encoding, load, out);
}

void decode_nv12(const Frame& frame, const ColorEncoding& encoding, Image<Rgb8>& out) {
  const auto load = [&](int x, int y, int count, Block& block) {
    std::copy_n(yuv_row(frame, y) + x, count, block.y.data());
    libyuv::SplitUVPlane(yuv_row(frame, frame.size.height + y / 2) + x, 0, block.u.data(), 0,
                         block.v.data(), 0, (count + 1) / 2, 1);
  };
  convert_rows(frame.size, encoding, load, out);
}

}  // namespace mixrig::capture
