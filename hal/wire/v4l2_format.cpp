// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/v4l2_format.h"

#include <algorithm>
#include <array>

namespace mixrig::device {
namespace {

struct Known {
  std::uint32_t code;
  PixelFormat format;
  int rank;  ///< lower is taken first where the request leaves the format open
};
constexpr std::array<Known, 14> kKnown = {{
    {fourcc('Y', 'U', 'Y', 'V'), PixelFormat::kYuyv, 0},
    {fourcc('N', 'V', '1', '2'), PixelFormat::kNv12, 1},
    {fourcc('R', 'G', 'B', '3'), PixelFormat::kRgb8, 2},
    {fourcc('B', 'G', 'R', '3'), PixelFormat::kBgr8, 2},
    {fourcc('M', 'J', 'P', 'G'), PixelFormat::kMjpeg, 3},
    {fourcc('J', 'P', 'E', 'G'), PixelFormat::kMjpeg, 3},
    {fourcc('R', 'G', 'G', 'B'), PixelFormat::kBayerRggb8, 4},
    {fourcc('G', 'R', 'B', 'G'), PixelFormat::kBayerGrbg8, 4},
    {fourcc('G', 'B', 'R', 'G'), PixelFormat::kBayerGbrg8, 4},
    {fourcc('B', 'A', '8', '1'), PixelFormat::kBayerBggr8, 4},
    {fourcc('Z', '1', '6', ' '), PixelFormat::kDepth16, 5},
    {fourcc('G', 'R', 'E', 'Y'), PixelFormat::kGray8, 6},
    {fourcc('Y', '1', '6', ' '), PixelFormat::kGray16, 7},
    {fourcc('Y', '1', '2', ' '), PixelFormat::kGray16, 8},
}};
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
  bool rate = false, moderate = false;  ///< keeps the requested rate; at most kLargestDefault
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

Result<V4l2Layout> checked_layout(std::uint32_t code, std::uint32_t width, std::uint32_t height,
                                  std::uint32_t bytes_per_line, std::uint32_t size_image) {
  V4l2Layout layout;
  layout.format = format_of_fourcc(code);
  const bool sane = layout.format != PixelFormat::kUnknown && width > 0 && height > 0 &&
                    width <= kLargestSide && height <= kLargestSide;
  if (!sane)
    return Error{ErrorCode::kDevice, "the driver chose a format that mixrig does not read"};
  layout.size = {static_cast<int>(width), static_cast<int>(height)};
  if (layout.format == PixelFormat::kMjpeg) {
    // No JPEG file is longer than its pixels; some drivers report gigabytes.
    const std::size_t most = layout.size.area() * 3 + kJpegHeader;
    layout.picture_bytes = size_image > 0 ? std::min<std::size_t>(size_image, most) : most;
    return layout;
  }
  const std::size_t row = row_bytes(layout.format, layout.size.width);
  layout.stride_bytes = bytes_per_line > 0 ? bytes_per_line : row;
  layout.picture_bytes = image_bytes(layout.format, layout.size, layout.stride_bytes);
  if (layout.stride_bytes < row || layout.stride_bytes > 4 * row + 4096 ||
      size_image < layout.picture_bytes)
    return Error{ErrorCode::kDevice, "the driver's stride or image size cannot hold its picture"};
  return layout;
}

std::uint32_t payload_flags(const V4l2Layout& layout, std::size_t used, bool driver_error) {
  const bool jpeg = layout.format == PixelFormat::kMjpeg;
  const bool whole =
      jpeg ? used >= 4 && used <= layout.picture_bytes : used >= layout.picture_bytes;
  return whole && !driver_error ? kFrameOk : kFrameIncomplete;
}

}  // namespace mixrig::device
