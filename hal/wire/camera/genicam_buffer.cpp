// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/genicam_buffer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "hal/wire/camera/packed_samples.h"

namespace mixrig::device {
namespace {

struct Code {
  std::uint32_t code;
  PixelFormat format;
  SamplePacking packing = SamplePacking::kNone;
  int bits = 8;
};
// The preferred code of a format comes first. Mono10 and BayerRG10 are words, the p formats are
// streams of bits, lowest first.
constexpr auto kCodes = std::to_array<Code>({
    {pfnc::kRgb8, PixelFormat::kRgb8},
    {pfnc::kBgr8, PixelFormat::kBgr8},
    {pfnc::kYuyv, PixelFormat::kYuyv},
    {pfnc::kMono8, PixelFormat::kGray8},
    {pfnc::kMono16, PixelFormat::kGray16, SamplePacking::kNone, 16},
    {pfnc::kMono12p, PixelFormat::kGray16, SamplePacking::kLittle, 12},
    {pfnc::kMono12, PixelFormat::kGray16, SamplePacking::kWords, 12},
    {pfnc::kMono10p, PixelFormat::kGray16, SamplePacking::kLittle, 10},
    {pfnc::kMono10, PixelFormat::kGray16, SamplePacking::kWords, 10},
    {pfnc::kBayerRg8, PixelFormat::kBayerRggb8},
    {pfnc::kBayerGr8, PixelFormat::kBayerGrbg8},
    {pfnc::kBayerGb8, PixelFormat::kBayerGbrg8},
    {pfnc::kBayerBg8, PixelFormat::kBayerBggr8},
    {pfnc::kBayerRg12p, PixelFormat::kBayerRggb16, SamplePacking::kLittle, 12},
    {0x010C0057, PixelFormat::kBayerGrbg16, SamplePacking::kLittle, 12},
    {0x010C0055, PixelFormat::kBayerGbrg16, SamplePacking::kLittle, 12},
    {0x010C0053, PixelFormat::kBayerBggr16, SamplePacking::kLittle, 12},
    {0x01100011, PixelFormat::kBayerRggb16, SamplePacking::kWords, 12},
    {0x01100010, PixelFormat::kBayerGrbg16, SamplePacking::kWords, 12},
    {0x01100012, PixelFormat::kBayerGbrg16, SamplePacking::kWords, 12},
    {0x01100013, PixelFormat::kBayerBggr16, SamplePacking::kWords, 12},
    {pfnc::kBayerRg10p, PixelFormat::kBayerRggb16, SamplePacking::kLittle, 10},
    {0x010A0056, PixelFormat::kBayerGrbg16, SamplePacking::kLittle, 10},
    {0x010A0054, PixelFormat::kBayerGbrg16, SamplePacking::kLittle, 10},
    {0x010A0052, PixelFormat::kBayerBggr16, SamplePacking::kLittle, 10},
    {0x0110000D, PixelFormat::kBayerRggb16, SamplePacking::kWords, 10},
    {0x0110000C, PixelFormat::kBayerGrbg16, SamplePacking::kWords, 10},
    {0x0110000E, PixelFormat::kBayerGbrg16, SamplePacking::kWords, 10},
    {0x0110000F, PixelFormat::kBayerBggr16, SamplePacking::kWords, 10},
});

/// Position of the samples in a Coord3D format. The preferred formats, those with an amplitude,
/// come first.
struct Coord3d {
  std::uint32_t code;
  std::size_t pixel_bytes, c_at;
  bool is_float = false;
  std::size_t y_at = 0;  ///< position of the intensity; 0: none
};
constexpr auto kCoord3d = std::to_array<Coord3d>({
    {pfnc::kCoord3dAbcy16, 8, 4, false, 6},
    {pfnc::kCoord3dC16, 2, 0},
    {pfnc::kCoord3dAbc16, 6, 4},
    {pfnc::kCoord3dC32f, 4, 0, true},
    {pfnc::kCoord3dAbc32f, 12, 8, true},
});
constexpr int kLongestSide = 16384;

template <typename Table>
auto* find_code(const Table& table, std::uint32_t code) {
  const auto* at =
      std::find_if(table.begin(), table.end(), [&](const auto& c) { return c.code == code; });
  return at == table.end() ? nullptr : at;
}

std::uint16_t step_of(const std::uint8_t* bytes, const FloatDepth& floats) {
  const std::uint32_t bits =
      static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8 |
      static_cast<std::uint32_t>(bytes[2]) << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
  const auto value = std::bit_cast<float>(bits);
  if (!std::isfinite(value) || value == floats.invalid) return 0;
  const double step = (floats.scale_m * value + floats.offset_m) / kFloatDepthStep_m;
  return step >= 0.5 && step < 65535.5 ? static_cast<std::uint16_t>(std::lround(step))
                                       : std::uint16_t{0};
}

void put_u16(std::uint8_t* out, unsigned value) {
  out[0] = static_cast<std::uint8_t>(value);
  out[1] = static_cast<std::uint8_t>(value >> 8);
}

void copy_words(const std::uint8_t* in, std::size_t pixel_bytes, std::size_t count,
                std::uint8_t* out) {
  for (std::size_t i = 0; i < count; ++i, in += pixel_bytes, out += 2)
    out[0] = in[0], out[1] = in[1];
}

/// Copies samples of 8 or 16 bits as 16-bit ones; returns the number of bytes.
std::size_t copy_map(const GenicamPart& part, Size size, int bits, std::span<std::uint8_t> out) {
  const std::size_t count = size.area(), bytes = static_cast<std::size_t>(bits) / 8;
  if (part.size != size || part.data.size() < bytes * count || out.size() < 2 * count) return 0;
  if (bits == 16)
    copy_words(part.data.data(), 2, count, out.data());
  else
    for (std::size_t i = 0; i < count; ++i) put_u16(&out[2 * i], 257U * part.data[i]);
  return 2 * count;
}

std::size_t copy_c(const GenicamPart& part, const Coord3d& kind, Size size,
                   const FloatDepth& floats, std::span<std::uint8_t> out) {
  const std::size_t count = size.area();
  if (part.size != size || part.data.size() < kind.pixel_bytes * count || out.size() < 2 * count)
    return 0;
  const std::uint8_t* in = part.data.data() + kind.c_at;
  if (!kind.is_float)
    copy_words(in, kind.pixel_bytes, count, out.data());
  else
    for (std::size_t i = 0; i < count; ++i, in += kind.pixel_bytes)
      put_u16(&out[2 * i], step_of(in, floats));
  return 2 * count;
}

}  // namespace

PixelFormat format_of_pfnc(std::uint32_t code) {
  if (is_coord3d(code)) return PixelFormat::kDepth16;
  const Code* known = find_code(kCodes, code);
  return known != nullptr ? known->format : PixelFormat::kUnknown;
}

std::vector<std::uint32_t> pfncs_of_format(PixelFormat format) {
  std::vector<std::uint32_t> codes;
  for (const Code& c : kCodes)
    if (c.format == format) codes.push_back(c.code);
  if (format == PixelFormat::kDepth16)
    for (const Coord3d& c : kCoord3d) codes.push_back(c.code);
  return codes;
}

int sample_bits_of_pfnc(std::uint32_t code) {
  const Code* known = find_code(kCodes, code);
  return known != nullptr ? known->bits : 8;
}

bool is_coord3d(std::uint32_t code) { return find_code(kCoord3d, code) != nullptr; }

bool is_float(std::uint32_t code) {
  const Coord3d* kind = find_code(kCoord3d, code);
  return kind != nullptr && kind->is_float;
}

std::size_t declared_bytes(std::uint32_t code, Size size) {
  if (size.empty() || size.width > kLongestSide || size.height > kLongestSide) return 0;
  if (const Coord3d* kind = find_code(kCoord3d, code)) return kind->pixel_bytes * size.area();
  const Code* known = find_code(kCodes, code);
  if (known == nullptr) return 0;
  if (known->packing == SamplePacking::kLittle)  // rows follow each other without a gap
    return (size.area() * static_cast<std::size_t>(known->bits) + 7) / 8;
  return image_bytes(known->format, size, row_bytes(known->format, size.width));
}

bool copy_picture(std::uint32_t code, Size size, std::span<const std::uint8_t> data,
                  std::span<std::uint8_t> out) {
  const std::size_t declared = declared_bytes(code, size);
  const Code* known = find_code(kCodes, code);
  if (declared == 0 || known == nullptr || data.size() < declared) return false;
  if (known->packing == SamplePacking::kNone) {
    if (out.size() < declared) return false;
    std::copy_n(data.begin(), declared, out.begin());
    return true;
  }
  // One row of all samples.
  const auto count = static_cast<int>(size.area());
  const std::size_t row = packed_row_bytes(known->packing, known->bits, count);
  return unpack_samples({known->packing, known->bits, {count, 1}, row}, data, out);
}

DepthUsed copy_depth(std::span<const GenicamPart> parts, Size size, const FloatDepth& floats,
                     const DepthBuffers& out) {
  DepthUsed used;
  if (size.empty() || size.width > kLongestSide || size.height > kLongestSide) return used;
  for (const GenicamPart& part : parts) {
    const Coord3d* kind = find_code(kCoord3d, part.code);
    if (kind != nullptr && used.depth == 0) {
      used.depth = copy_c(part, *kind, size, floats, out.depth);
      if (used.depth > 0 && kind->y_at > 0 && out.amplitude.size() >= 2 * size.area()) {
        copy_words(part.data.data() + kind->y_at, kind->pixel_bytes, size.area(),
                   out.amplitude.data());
        used.amplitude = used.depth;
      }
    } else if (part.code == pfnc::kMono16 || part.code == pfnc::kMono8) {
      const int bits = part.code == pfnc::kMono16 ? 16 : 8;
      if (used.amplitude == 0) used.amplitude = copy_map(part, size, bits, out.amplitude);
    } else if (part.code == pfnc::kConfidence16 || part.code == pfnc::kConfidence8) {
      const int bits = part.code == pfnc::kConfidence16 ? 16 : 8;
      if (used.confidence == 0) used.confidence = copy_map(part, size, bits, out.confidence);
    }
  }
  return used.depth > 0 ? used : DepthUsed();
}

}  // namespace mixrig::device
