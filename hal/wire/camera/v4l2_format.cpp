// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/v4l2_format.h"

#include <algorithm>
#include <array>

namespace mixrig::device {
namespace {

struct Known {
  std::uint32_t code;
  PixelFormat format;
  int rank;  ///< lower ranks come first if the request leaves the format open
  SamplePacking packing = SamplePacking::kNone;
  int bits = 8;
  std::size_t planes = 1;
};
using enum SamplePacking;
// Layouts: Documentation/userspace-api/media/v4l/pixfmt-*.rst of the kernel.
constexpr auto kKnown = std::to_array<Known>({
    {fourcc('Y', 'U', 'Y', 'V'), PixelFormat::kYuyv, 0},
    {fourcc('N', 'V', '1', '2'), PixelFormat::kNv12, 1},
    {fourcc('N', 'M', '1', '2'), PixelFormat::kNv12, 1, kNone, 8, 2},
    {fourcc('R', 'G', 'B', '3'), PixelFormat::kRgb8, 2},
    {fourcc('B', 'G', 'R', '3'), PixelFormat::kBgr8, 2},
    {fourcc('M', 'J', 'P', 'G'), PixelFormat::kMjpeg, 3},
    {fourcc('J', 'P', 'E', 'G'), PixelFormat::kMjpeg, 3},
    {fourcc('R', 'G', 'G', 'B'), PixelFormat::kBayerRggb8, 4},
    {fourcc('G', 'R', 'B', 'G'), PixelFormat::kBayerGrbg8, 4},
    {fourcc('G', 'B', 'R', 'G'), PixelFormat::kBayerGbrg8, 4},
    {fourcc('B', 'A', '8', '1'), PixelFormat::kBayerBggr8, 4},
    {fourcc('R', 'G', '1', '4'), PixelFormat::kBayerRggb16, 5, kWords, 14},
    {fourcc('G', 'R', '1', '4'), PixelFormat::kBayerGrbg16, 5, kWords, 14},
    {fourcc('G', 'B', '1', '4'), PixelFormat::kBayerGbrg16, 5, kWords, 14},
    {fourcc('B', 'G', '1', '4'), PixelFormat::kBayerBggr16, 5, kWords, 14},
    {fourcc('R', 'G', '1', '2'), PixelFormat::kBayerRggb16, 5, kWords, 12},
    {fourcc('B', 'A', '1', '2'), PixelFormat::kBayerGrbg16, 5, kWords, 12},
    {fourcc('G', 'B', '1', '2'), PixelFormat::kBayerGbrg16, 5, kWords, 12},
    {fourcc('B', 'G', '1', '2'), PixelFormat::kBayerBggr16, 5, kWords, 12},
    {fourcc('p', 'R', 'C', 'C'), PixelFormat::kBayerRggb16, 5, kMipi, 12},
    {fourcc('p', 'g', 'C', 'C'), PixelFormat::kBayerGrbg16, 5, kMipi, 12},
    {fourcc('p', 'G', 'C', 'C'), PixelFormat::kBayerGbrg16, 5, kMipi, 12},
    {fourcc('p', 'B', 'C', 'C'), PixelFormat::kBayerBggr16, 5, kMipi, 12},
    {fourcc('R', 'G', '1', '0'), PixelFormat::kBayerRggb16, 6, kWords, 10},
    {fourcc('B', 'A', '1', '0'), PixelFormat::kBayerGrbg16, 6, kWords, 10},
    {fourcc('G', 'B', '1', '0'), PixelFormat::kBayerGbrg16, 6, kWords, 10},
    {fourcc('B', 'G', '1', '0'), PixelFormat::kBayerBggr16, 6, kWords, 10},
    {fourcc('p', 'R', 'A', 'A'), PixelFormat::kBayerRggb16, 6, kMipi, 10},
    {fourcc('p', 'g', 'A', 'A'), PixelFormat::kBayerGrbg16, 6, kMipi, 10},
    {fourcc('p', 'G', 'A', 'A'), PixelFormat::kBayerGbrg16, 6, kMipi, 10},
    {fourcc('p', 'B', 'A', 'A'), PixelFormat::kBayerBggr16, 6, kMipi, 10},
    {fourcc('R', 'G', '1', '6'), PixelFormat::kBayerRggb16, 7, kNone, 16},
    {fourcc('G', 'R', '1', '6'), PixelFormat::kBayerGrbg16, 7, kNone, 16},
    {fourcc('G', 'B', '1', '6'), PixelFormat::kBayerGbrg16, 7, kNone, 16},
    {fourcc('B', 'Y', 'R', '2'), PixelFormat::kBayerBggr16, 7, kNone, 16},
    {fourcc('Z', '1', '6', ' '), PixelFormat::kDepth16, 8, kNone, 16},
    {fourcc('G', 'R', 'E', 'Y'), PixelFormat::kGray8, 9},
    {fourcc('Y', '1', '6', ' '), PixelFormat::kGray16, 10, kNone, 16},
    {fourcc('Y', '1', '4', ' '), PixelFormat::kGray16, 11, kWords, 14},
    {fourcc('Y', '1', '2', ' '), PixelFormat::kGray16, 11, kWords, 12},
    {fourcc('Y', '1', '2', 'P'), PixelFormat::kGray16, 11, kMipi, 12},
    {fourcc('Y', '1', '0', ' '), PixelFormat::kGray16, 12, kWords, 10},
    {fourcc('Y', '1', '0', 'P'), PixelFormat::kGray16, 12, kMipi, 10},
    {fourcc('Y', '1', '0', 'B'), PixelFormat::kGray16, 12, kBig, 10},
});
constexpr Size kLargestDefault{1920, 1200};
constexpr int kLargestSide = 16384;
constexpr std::size_t kJpegHeader = 65536;

const Known* find(std::uint32_t code) {
  const auto* known =
      std::find_if(kKnown.begin(), kKnown.end(), [&](const Known& k) { return k.code == code; });
  return known == kKnown.end() ? nullptr : known;
}

int fit_side(int wanted, int low, int high, int step) {
  const int inside = std::clamp(wanted, low, high);
  return step > 1 ? low + (inside - low) / step * step : inside;
}

/// The size of this mode for the request; empty when the mode does not offer it.
std::optional<Size> size_of(const V4l2Mode& mode, Size wanted) {
  if (mode.minimum.empty() || mode.maximum.width < mode.minimum.width ||
      mode.maximum.height < mode.minimum.height || mode.maximum.width > kLargestSide ||
      mode.maximum.height > kLargestSide)
    return std::nullopt;
  const Size aim = wanted.empty() ? kLargestDefault : wanted;
  const Size size{fit_side(aim.width, mode.minimum.width, mode.maximum.width, mode.step.width),
                  fit_side(aim.height, mode.minimum.height, mode.maximum.height, mode.step.height)};
  if (!wanted.empty() && size != wanted) return std::nullopt;
  return size;
}

struct Score {
  /// It keeps the requested rate; its size is at most kLargestDefault.
  bool rate = false, moderate = false;
  int rank = 0;
  std::size_t area = 0;
  bool better_than(const Score& other) const {
    if (rate != other.rate) return rate;
    if (moderate != other.moderate) return moderate;
    if (rank != other.rank) return rank < other.rank;
    return area > other.area;
  }
};

std::string text_of(const StreamRequest& request) {
  std::string text =
      request.format == PixelFormat::kUnknown ? "any format" : std::string(name(request.format));
  if (!request.size.empty())
    text += " of " + std::to_string(request.size.width) + "x" + std::to_string(request.size.height);
  return text;
}

}  // namespace

PixelFormat format_of_fourcc(std::uint32_t code) {
  const Known* known = find(code);
  return known != nullptr ? known->format : PixelFormat::kUnknown;
}

Result<V4l2Choice> choose_mode(std::span<const V4l2Mode> modes, const StreamRequest& request) {
  std::optional<V4l2Choice> best;
  Score best_score;
  for (const V4l2Mode& mode : modes) {
    const Known* known = find(mode.code);
    if (known == nullptr) continue;
    if (request.format != PixelFormat::kUnknown && known->format != request.format) continue;
    const auto size = size_of(mode, request.size);
    if (!size) continue;
    const Score score{
        .rate = request.rate_hz <= 0 || mode.max_rate_hz <= 0 ||
                mode.max_rate_hz >= request.rate_hz * 0.99,
        .moderate = size->width <= kLargestDefault.width && size->height <= kLargestDefault.height,
        .rank = known->rank,
        .area = size->area()};
    if (best && !score.better_than(best_score)) continue;
    best = V4l2Choice{mode.code, known->format, *size};
    best_score = score;
  }
  if (best) return *best;
  return Error{ErrorCode::kUnsupported,
               "the camera does not offer " + text_of(request) +
                   ": see what it offers with v4l2-ctl --list-formats-ext"};
}

namespace {

/// Bytes of a row of one plane as the driver stores it.
std::size_t plane_row_bytes(const Known& known, Size size) {
  if (known.packing != kNone) return packed_row_bytes(known.packing, known.bits, size.width);
  const int pairs = known.format == PixelFormat::kNv12 ? size.width % 2 : 0;  // bytes of chroma
  return row_bytes(known.format, known.planes == 2 ? size.width + pairs : size.width);
}

std::size_t plane_rows(const Known& known, Size size, std::size_t plane) {
  const auto rows = static_cast<std::size_t>(size.height);
  if (known.planes == 2) return plane == 0 ? rows : (rows + 1) / 2;
  return known.format == PixelFormat::kNv12 ? rows + (rows + 1) / 2 : rows;
}

}  // namespace

Result<V4l2Layout> checked_layout(std::uint32_t code, std::uint32_t width, std::uint32_t height,
                                  std::span<const V4l2Plane> planes) {
  const Known* known = find(code);
  if (known == nullptr || width == 0 || height == 0 || width > kLargestSide ||
      height > kLargestSide || planes.size() != known->planes)
    return Error{ErrorCode::kDevice, "the driver chose a format that mixrig does not read"};
  V4l2Layout layout;
  layout.format = known->format;
  layout.size = {static_cast<int>(width), static_cast<int>(height)};
  layout.sample_bits = known->bits;
  layout.planes = known->planes;
  if (layout.format == PixelFormat::kMjpeg) {
    // No JPEG file is longer than its pixels; some drivers report gigabytes.
    const std::size_t most = layout.size.area() * 3 + kJpegHeader;
    layout.picture_bytes =
        planes[0].bytes > 0 ? std::min<std::size_t>(planes[0].bytes, most) : most;
    return layout;
  }
  const std::size_t row = plane_row_bytes(*known, layout.size);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::size_t stride = planes[i].stride_bytes > 0 ? planes[i].stride_bytes : row;
    layout.plane_stride_bytes[i] = stride;
    layout.plane_bytes[i] = stride * plane_rows(*known, layout.size, i);
    if (stride < row || stride > 4 * row + 4096 || planes[i].bytes < layout.plane_bytes[i])
      return Error{ErrorCode::kDevice, "the driver's stride or image size cannot hold its picture"};
  }
  if (known->packing != kNone) {
    layout.packed = {known->packing, known->bits, layout.size, layout.plane_stride_bytes[0]};
    layout.stride_bytes = row_bytes(layout.format, layout.size.width);
  } else {
    layout.stride_bytes = layout.plane_stride_bytes[0];
  }
  layout.picture_bytes = image_bytes(layout.format, layout.size, layout.stride_bytes);
  return layout;
}

std::uint32_t payload_flags(const V4l2Layout& layout, const V4l2Bytes& bytes, bool driver_error) {
  bool whole = !driver_error;
  if (layout.format == PixelFormat::kMjpeg)
    whole &= bytes[0].size() >= 4 && bytes[0].size() <= layout.picture_bytes;
  else
    for (std::size_t i = 0; i < layout.planes; ++i)
      whole &= bytes[i].size() >= layout.plane_bytes[i];
  return whole ? kFrameOk : kFrameIncomplete;
}

std::size_t copy_v4l2_picture(const V4l2Layout& layout, const V4l2Bytes& bytes,
                              std::span<std::uint8_t> out) {
  if (layout.packed.packing != kNone)
    return unpack_samples(layout.packed, bytes[0], out) ? layout.picture_bytes : 0;
  if (layout.planes == 1) {
    const std::size_t used = std::min(bytes[0].size(), out.size());
    std::copy_n(bytes[0].begin(), used, out.begin());
    return used;
  }
  std::size_t to = 0;
  for (std::size_t i = 0; i < layout.planes; ++i) {
    const std::size_t stride = layout.plane_stride_bytes[i];
    const std::size_t row = std::min(stride, layout.stride_bytes);
    const std::size_t rows = layout.plane_bytes[i] / stride;
    for (std::size_t y = 0; y < rows; ++y, to += layout.stride_bytes) {
      if (y * stride + row > bytes[i].size() || to + row > out.size()) return to;
      std::copy_n(bytes[i].begin() + static_cast<std::ptrdiff_t>(y * stride), row,
                  out.begin() + static_cast<std::ptrdiff_t>(to));
    }
  }
  return layout.picture_bytes;
}

}  // namespace mixrig::device
