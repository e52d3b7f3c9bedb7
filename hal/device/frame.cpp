// SPDX-License-Identifier: Apache-2.0
#include "hal/device/frame.h"

namespace mixrig::device {

std::string_view name(PixelFormat format) {
  switch (format) {
    case PixelFormat::kUnknown:
      return "unknown";
    case PixelFormat::kRgb8:
      return "rgb8";
    case PixelFormat::kBgr8:
      return "bgr8";
    case PixelFormat::kYuyv:
      return "yuyv";
    case PixelFormat::kNv12:
      return "nv12";
    case PixelFormat::kMjpeg:
      return "mjpeg";
    case PixelFormat::kGray8:
      return "gray8";
    case PixelFormat::kGray16:
      return "gray16";
    case PixelFormat::kBayerRggb8:
      return "bayer_rggb8";
    case PixelFormat::kBayerGrbg8:
      return "bayer_grbg8";
    case PixelFormat::kBayerGbrg8:
      return "bayer_gbrg8";
    case PixelFormat::kBayerBggr8:
      return "bayer_bggr8";
    case PixelFormat::kDepth16:
      return "depth16";
    case PixelFormat::kBayerRggb16:
      return "bayer_rggb16";
    case PixelFormat::kBayerGrbg16:
      return "bayer_grbg16";
    case PixelFormat::kBayerGbrg16:
      return "bayer_gbrg16";
    case PixelFormat::kBayerBggr16:
      return "bayer_bggr16";
  }
  return "unknown";
}

std::size_t row_bytes(PixelFormat format, int width) {
  const auto w = static_cast<std::size_t>(width > 0 ? width : 0);
  switch (format) {
    case PixelFormat::kUnknown:
    case PixelFormat::kMjpeg:
      return 0;
    case PixelFormat::kRgb8:
    case PixelFormat::kBgr8:
      return 3 * w;
    case PixelFormat::kYuyv:
      return 4 * ((w + 1) / 2);
    case PixelFormat::kGray16:
    case PixelFormat::kDepth16:
    case PixelFormat::kBayerRggb16:
    case PixelFormat::kBayerGrbg16:
    case PixelFormat::kBayerGbrg16:
    case PixelFormat::kBayerBggr16:
      return 2 * w;
    default:
      return w;
  }
}

std::size_t image_bytes(PixelFormat format, Size size, std::size_t stride) {
  if (size.empty() || row_bytes(format, size.width) == 0) return 0;
  const auto rows = static_cast<std::size_t>(size.height);
  return format == PixelFormat::kNv12 ? stride * (rows + (rows + 1) / 2) : stride * rows;
}

}  // namespace mixrig::device
