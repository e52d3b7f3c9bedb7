// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/genicam_buffer.h"

#include <algorithm>
#include <array>

namespace mixrig::device {
namespace {

struct Code {
  std::uint32_t code;
  PixelFormat format;
};
constexpr std::array<Code, 11> kCodes = {{{pfnc::kRgb8, PixelFormat::kRgb8},
                                          {pfnc::kBgr8, PixelFormat::kBgr8},
                                          {pfnc::kYuyv, PixelFormat::kYuyv},
                                          {pfnc::kMono8, PixelFormat::kGray8},
                                          {pfnc::kMono16, PixelFormat::kGray16},
                                          {pfnc::kBayerRg8, PixelFormat::kBayerRggb8},
                                          {pfnc::kBayerGr8, PixelFormat::kBayerGrbg8},
                                          {pfnc::kBayerGb8, PixelFormat::kBayerGbrg8},
                                          {pfnc::kBayerBg8, PixelFormat::kBayerBggr8},
                                          {pfnc::kCoord3dC16, PixelFormat::kDepth16},
                                          {pfnc::kCoord3dAbc16, PixelFormat::kDepth16}}};
constexpr int kLongestSide = 16384;
constexpr std::size_t kAbcBytes = 6, kCAt = 4;

}  // namespace

PixelFormat format_of_pfnc(std::uint32_t code) {
  for (const Code& c : kCodes)
    if (c.code == code) return c.format;
  return PixelFormat::kUnknown;
}

std::uint32_t pfnc_of_format(PixelFormat format) {
  for (const Code& c : kCodes)
    if (c.format == format) return c.code;
  return 0;
}

std::size_t declared_bytes(std::uint32_t code, Size size) {
  if (size.empty() || size.width > kLongestSide || size.height > kLongestSide) return 0;
  if (code == pfnc::kCoord3dAbc16) return kAbcBytes * size.area();
  const PixelFormat format = format_of_pfnc(code);
  return image_bytes(format, size, row_bytes(format, size.width));
}

bool copy_picture(std::uint32_t code, Size size, std::span<const std::uint8_t> data,
                  std::span<std::uint8_t> out) {
  const std::size_t declared = declared_bytes(code, size);
  if (declared == 0 || data.size() < declared) return false;
  if (code != pfnc::kCoord3dAbc16) {
    if (out.size() < declared) return false;
    std::copy_n(data.begin(), declared, out.begin());
    return true;
  }
  if (out.size() < 2 * size.area()) return false;
  const std::uint8_t* source = data.data() + kCAt;
  for (std::size_t i = 0; i < size.area(); ++i, source += kAbcBytes) {
    out[2 * i] = source[0];
    out[2 * i + 1] = source[1];
  }
  return true;
}

}  // namespace mixrig::device
