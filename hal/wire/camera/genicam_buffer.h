// SPDX-License-Identifier: Apache-2.0
// Buffers of GenICam cameras: declared geometry against delivered bytes, pure and bounded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/base/image.h"
#include "hal/device/frame.h"

namespace mixrig::device {

/// Pixel formats by their PFNC codes (GenICam Pixel Format Naming Convention).
namespace pfnc {
inline constexpr std::uint32_t kMono8 = 0x01080001, kMono16 = 0x01100007, kRgb8 = 0x02180014,
                               kBgr8 = 0x02180015, kBayerGr8 = 0x01080008, kBayerRg8 = 0x01080009,
                               kBayerGb8 = 0x0108000A, kBayerBg8 = 0x0108000B, kYuyv = 0x02100032,
                               kMono10 = 0x01100003, kMono12 = 0x01100005, kMono10p = 0x010A0046,
                               kMono12p = 0x010C0047, kBayerRg10p = 0x010A0058,
                               kBayerRg12p = 0x010C0059, kCoord3dC16 = 0x011000B8,
                               kCoord3dAbc16 = 0x023000B9, kCoord3dC32f = 0x012000BF,
                               kCoord3dAbc32f = 0x026000C0, kConfidence8 = 0x010800C6,
                               kConfidence16 = 0x011000C7;
/// Not of the PFNC, but LUCID's own: A, B, C and the intensity, 16 bit each.
inline constexpr std::uint32_t kCoord3dAbcy16 = 0x82400403;
}  // namespace pfnc

/// kUnknown for formats that mixrig does not read. All Coord3D formats become kDepth16.
PixelFormat format_of_pfnc(std::uint32_t code);
/// Those that become `format`, the preferred first.
std::vector<std::uint32_t> pfncs_of_format(PixelFormat format);
/// Of a sample of a grey or Bayer format; 8 for all others.
int sample_bits_of_pfnc(std::uint32_t code);
bool is_coord3d(std::uint32_t code);
bool is_float(std::uint32_t code);

/// Bytes of a picture as the camera declares it; 0 for unknown codes and empty sizes.
std::size_t declared_bytes(std::uint32_t code, Size size);

/// Copies the declared picture, and only that, into `out`: some cameras send more than width *
/// height * bytes per pixel. Packed samples are unpacked (unpack_samples). Not for Coord3D.
/// False where `data` is shorter than declared or `out` cannot hold it.
bool copy_picture(std::uint32_t code, Size size, std::span<const std::uint8_t> data,
                  std::span<std::uint8_t> out);

/// Steps of frames that are made of floats: 0.25 mm, 0 to 16.38 m, 0 = unknown.
inline constexpr double kFloatDepthStep_m = 0.00025;
/// Metres of a float coordinate: scale_m * value + offset_m, except `invalid`, NaN and infinity.
struct FloatDepth {
  double scale_m = 0.001, offset_m = 0;
  std::optional<float> invalid{};
};

/// One part of a buffer; a buffer that is not multi-part is one part.
struct GenicamPart {
  std::uint32_t code = 0;
  Size size{};
  std::span<const std::uint8_t> data{};
};
/// Where the 16-bit samples of a depth frame go, row by row without padding.
struct DepthBuffers {
  std::span<std::uint8_t> depth, amplitude, confidence;
};
/// What copy_depth found, in bytes; 0: no such part.
struct DepthUsed {
  std::size_t depth = 0, amplitude = 0, confidence = 0;
};
/// Makes a depth frame of `size` of the parts: C of the first Coord3D part; amplitude of a Mono8 or
/// Mono16 part, or of the Y of ABCY16; confidence of a Confidence8 or Confidence16 part. 8-bit
/// samples become 16-bit ones (255 becomes 65535). Parts that are short or of another size are left
/// out; without depth nothing is found.
DepthUsed copy_depth(std::span<const GenicamPart> parts, Size size, const FloatDepth& floats,
                     const DepthBuffers& out);

}  // namespace mixrig::device
