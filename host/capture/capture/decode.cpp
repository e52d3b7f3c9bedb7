// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/decode.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <libyuv.h>

#include "hal/base/srgb.h"
#include "host/capture/capture/yuv.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::capture {
namespace {

using device::Frame;
using device::PixelFormat;
using device::Transfer;

const std::uint8_t* row_of(const Frame& frame, int y) {
  return frame.bytes.data() + static_cast<std::size_t>(y) * frame.stride_bytes;
}

int stride_bytes(const Image<Rgb8>& image) { return static_cast<int>(image.stride()) * 3; }
std::uint8_t* bytes_of(Rgb8* pixels) { return reinterpret_cast<std::uint8_t*>(pixels); }

void decode_rgb(const Frame& frame, Image<Rgb8>& out) {
  for (int y = 0; y < frame.size.height; ++y)
    std::memcpy(out.row(y), row_of(frame, y), 3 * static_cast<std::size_t>(frame.size.width));
}

void decode_bgr(const Frame& frame, Image<Rgb8>& out) {
  libyuv::RAWToRGB24(row_of(frame, 0), static_cast<int>(frame.stride_bytes), bytes_of(out.row(0)),
                     stride_bytes(out), frame.size.width, frame.size.height);
}

std::uint8_t srgb_byte(const ColorSettings& settings, double gain, double sample) {
  if (settings.limited_samples) sample = (sample * 255 - 16) / 219;
  const double above = std::clamp((sample - settings.black) / (1 - settings.black), 0.0, 1.0);
  return srgb_byte_from_linear(static_cast<float>(gain * linear_light(settings.encoding, above)));
}

struct Bayer {
  int bytes, red_x, red_y;  ///< bytes of a sample; position of the first red one
};
Bayer bayer_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kBayerRggb8:
      return {1, 0, 0};
    case PixelFormat::kBayerGrbg8:
      return {1, 1, 0};
    case PixelFormat::kBayerGbrg8:
      return {1, 0, 1};
    case PixelFormat::kBayerBggr8:
      return {1, 1, 1};
    case PixelFormat::kBayerRggb16:
      return {2, 0, 0};
    case PixelFormat::kBayerGrbg16:
      return {2, 1, 0};
    case PixelFormat::kBayerGbrg16:
      return {2, 0, 1};
    default:
      return {2, 1, 1};
  }
}

/// Mirrors an index at the ends, which keeps its parity; a side of one pixel has only itself.
int mirrored(int at, int count) {
  if (count == 1) return 0;
  return at < 0 ? -at : at >= count ? 2 * count - 2 - at : at;
}

std::uint8_t mean(int a, int b) { return static_cast<std::uint8_t>((a + b + 1) / 2); }
std::uint8_t mean(int a, int b, int c, int d) {
  return static_cast<std::uint8_t>((a + b + c + d + 2) / 4);
}

/// Interpolates one row bilinearly; each row of samples has one more sample at both ends.
void interpolate_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                     int width, bool red_row, int red_x, Rgb8* out) {
  for (int x = 0; x < width; ++x) {
    const std::uint8_t own = here[x], across = mean(here[x - 1], here[x + 1]),
                       along = mean(above[x], below[x]);
    if ((x % 2 == red_x) == red_row) {  // a red or blue sample
      const std::uint8_t green = mean(here[x - 1], here[x + 1], above[x], below[x]);
      const std::uint8_t other = mean(above[x - 1], above[x + 1], below[x - 1], below[x + 1]);
      out[x] = red_row ? Rgb8{own, green, other} : Rgb8{other, green, own};
    } else {
      out[x] = red_row ? Rgb8{across, own, along} : Rgb8{along, own, across};
    }
  }
}

/// Errors: kData if there are fewer bytes than the picture needs.
Result<void> check_bytes(const Frame& frame) {
  // Chroma of NV12 comes in pairs of bytes.
  const int samples =
      frame.size.width + (frame.format == PixelFormat::kNv12 ? frame.size.width % 2 : 0);
  const std::size_t row = device::row_bytes(frame.format, samples);
  const std::size_t whole = device::image_bytes(frame.format, frame.size, frame.stride_bytes);
  if (row == 0 || frame.stride_bytes < row || whole == 0 ||
      frame.bytes.size() + frame.stride_bytes < whole + row)
    return Error{ErrorCode::kData, "a camera picture has fewer bytes than its size needs: dropped"};
  return {};
}

std::optional<RawLayout> raw_layout(PixelFormat format) {
  switch (format) {
    case PixelFormat::kYuyv:
      return RawLayout::kYuyv;
    case PixelFormat::kNv12:
      return RawLayout::kNv12;
    case PixelFormat::kGray8:
      return RawLayout::kGray;
    case PixelFormat::kBayerRggb8:
    case PixelFormat::kBayerGrbg8:
    case PixelFormat::kBayerGbrg8:
    case PixelFormat::kBayerBggr8:
      return RawLayout::kBayer;
    default:
      return std::nullopt;
  }
}

}  // namespace

double linear_light(const device::ColorEncoding& encoding, double sample) {
  switch (encoding.transfer) {
    case Transfer::kSrgb:
      return linear_from_srgb(sample);
    case Transfer::kBt709:  // the inverse of item 1.2 of ITU-R BT.709-6
      return sample < 0.081 ? sample / 4.5 : std::pow((sample + 0.099) / 1.099, 1 / 0.45);
    case Transfer::kLinear:
      return sample;
    case Transfer::kGamma:
      return std::pow(sample, encoding.gamma);
  }
  return sample;
}

ColorDecoder::ColorDecoder(const ColorSettings& settings)
    : encoding_(settings.encoding), mirrored_(settings.mirrored) {
  const std::array<double, 3> none{1, 1, 1};
  if (encoding_.transfer == Transfer::kSrgb && settings.black <= 0 && settings.gains == none &&
      !settings.limited_samples)
    return;
  tables_.resize(3);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < tables_[c].size(); ++i)
      tables_[c][i] = srgb_byte(settings, settings.gains[c],
                                static_cast<double>(i) / (static_cast<double>(1 << kBits) - 1));
    for (std::size_t i = 0; i < 256; ++i)
      byte_tables_[c][i] = srgb_byte(settings, settings.gains[c], static_cast<double>(i) / 255);
  }
  for (std::size_t i = 0; i < 256; ++i)
    samples_[i] = {byte_tables_[0][i], byte_tables_[1][i], byte_tables_[2][i], 255};
}

void ColorDecoder::map_rgb(Image<Rgb8>& image) const {
  for (int y = 0; y < image.height(); ++y) {
    Rgb8* row = image.row(y);
    for (int x = 0; x < image.width(); ++x)
      row[x] = {byte_tables_[0][row[x].r], byte_tables_[1][row[x].g], byte_tables_[2][row[x].b]};
  }
}

/// Decodes grey samples. Without tables a sample becomes its upper byte.
void ColorDecoder::decode_gray(const Frame& frame, int bytes, Image<Rgb8>& out) const {
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* in = row_of(frame, y);
    Rgb8* to = out.row(y);
    for (int x = 0; x < frame.size.width; ++x, in += bytes) {
      if (plain()) {
        to[x] = {in[bytes - 1], in[bytes - 1], in[bytes - 1]};
      } else if (bytes == 1) {
        to[x] = {byte_tables_[0][*in], byte_tables_[1][*in], byte_tables_[2][*in]};
      } else {
        const auto at = static_cast<std::size_t>(in[0] | in[1] << 8) >> (16 - kBits);
        to[x] = {tables_[0][at], tables_[1][at], tables_[2][at]};
      }
    }
  }
}

/// Maps the samples of row `y` to 8-bit sRGB, with one more at each end.
void ColorDecoder::map_bayer_row(const Frame& frame, int bytes, int red_x, int red_y, int y,
                                 std::uint8_t* out) const {
  const std::uint8_t* in = row_of(frame, mirrored(y, frame.size.height));
  const bool red_row = (y & 1) == red_y;
  for (int x = -1; x <= frame.size.width; ++x) {
    const int from = mirrored(x, frame.size.width);
    const std::uint8_t* sample = in + from * bytes;
    const bool red_column = (x & 1) == red_x;
    const std::size_t color = red_row != red_column ? 1 : red_row ? 0 : 2;
    if (plain())
      out[x] = sample[bytes - 1];
    else if (bytes == 1)
      out[x] = byte_tables_[color][*sample];
    else
      out[x] = tables_[color][static_cast<std::size_t>(sample[0] | sample[1] << 8) >> (16 - kBits)];
  }
}

void ColorDecoder::decode_bayer(const Frame& frame, Image<Rgb8>& out) {
  const auto [bytes, red_x, red_y] = bayer_of(frame.format);
  const auto pitch = static_cast<std::size_t>(frame.size.width) + 2;
  rows_.resize(3 * pitch);
  const auto row = [&](int y) {
    return rows_.data() + static_cast<std::size_t>((y + 3) % 3) * pitch + 1;
  };
  map_bayer_row(frame, bytes, red_x, red_y, -1, row(-1));
  map_bayer_row(frame, bytes, red_x, red_y, 0, row(0));
  for (int y = 0; y < frame.size.height; ++y) {
    map_bayer_row(frame, bytes, red_x, red_y, y + 1, row(y + 1));
    interpolate_row(row(y - 1), row(y), row(y + 1), frame.size.width, y % 2 == red_y, red_x,
                    out.row(y));
  }
}

Result<void> ColorDecoder::decode(const Frame& frame, Image<Rgb8>& out) {
  if (frame.format == PixelFormat::kMjpeg) {
    MIXRIG_TRY(
        image_io::decode_rgb8(frame.bytes.data(), frame.bytes.size(), "camera picture", out));
    if (!plain()) map_rgb(out);
    for (int y = 0; mirrored_ && y < out.height(); ++y)
      std::reverse(out.row(y), out.row(y) + out.width());
    return {};
  }
  MIXRIG_TRY(check_bytes(frame));
  if (frame.format == PixelFormat::kDepth16)
    return Error{ErrorCode::kData, "a camera sends depth16, which has no colour"};
  if (out.size() != frame.size) out.reset(frame.size);
  switch (frame.format) {
    case PixelFormat::kRgb8:
      decode_rgb(frame, out);
      break;
    case PixelFormat::kBgr8:
      decode_bgr(frame, out);
      break;
    case PixelFormat::kYuyv:
      decode_yuyv(frame, encoding_, out);
      break;
    case PixelFormat::kNv12:
      decode_nv12(frame, encoding_, out);
      break;
    case PixelFormat::kGray8:
      return decode_gray(frame, 1, out), Result<void>();
    case PixelFormat::kGray16:
      return decode_gray(frame, 2, out), Result<void>();
    default:
      return decode_bayer(frame, out), Result<void>();
  }
  if (!plain()) map_rgb(out);
  return {};
}

std::optional<RawPicture> ColorDecoder::raw(const Frame& frame) const {
  const auto layout = raw_layout(frame.format);
  if (!layout || !check_bytes(frame)) return std::nullopt;
  RawPicture picture{.layout = *layout,
                     .size = frame.size,
                     .stride_bytes = frame.stride_bytes,
                     .bytes = frame.bytes,
                     .samples = plain() ? nullptr : &samples_,
                     .memory = frame.memory};
  if (*layout == RawLayout::kBayer) {
    const Bayer bayer = bayer_of(frame.format);
    picture.red_x = bayer.red_x, picture.red_y = bayer.red_y;
  } else if (*layout != RawLayout::kGray) {
    picture.yuv = yuv_to_rgb(encoding_);
  }
  return picture;
}

}  // namespace mixrig::capture
