// SPDX-License-Identifier: Apache-2.0
// Copies buffers of GenICam cameras and checks their length against the declared geometry. Pure
// functions that never read past a buffer.
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
/// LUCID's own format, not in the PFNC: A, B, C and the intensity, 16 bit each.
inline constexpr std::uint32_t kCoord3dAbcy16 = 0x82400403;
}  // namespace pfnc

/// Returns kUnknown for formats that mixrig does not read. All Coord3D formats become kDepth16.
PixelFormat format_of_pfnc(std::uint32_t code);
/// Returns the PFNC codes that become `format`, the preferred one first.
std::vector<std::uint32_t> pfncs_of_format(PixelFormat format);
/// Returns the bits of a sample of a grey or Bayer format; 8 for all others.
int sample_bits_of_pfnc(std::uint32_t code);
bool is_coord3d(std::uint32_t code);
bool is_float(std::uint32_t code);

/// Bytes of a picture as the camera declares it; 0 for unknown codes and empty sizes.
std::size_t declared_bytes(std::uint32_t code, Size size);

/// Copies only the declared picture into `out`, since some cameras send more than width * height *
/// bytes per pixel. Packed samples are unpacked (unpack_samples). Not for Coord3D.
/// False where `data` is shorter than declared or `out` cannot hold it.
bool copy_picture(std::uint32_t code, Size size, std::span<const std::uint8_t> data,
                  std::span<std::uint8_t> out);

/// Depth step of frames that are made from floats: 0.25 mm, 0 to 16.38 m, 0 = unknown.
inline constexpr double kFloatDepthStep_m = 0.00025;
/// Converts a float coordinate: metres = scale_m * value + offset_m. `invalid`, NaN and infinity
/// are unknown.
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
/// Destination of the 16-bit samples of a depth frame, row by row without padding.
struct DepthBuffers {
  std::span<std::uint8_t> depth, amplitude, confidence;
};
/// Bytes that copy_depth() wrote of each kind; 0 where no part has it.
struct DepthUsed {
  std::size_t depth = 0, amplitude = 0, confidence = 0;
};
/// Makes a depth frame of `size` from the parts: depth from C of the first Coord3D part, amplitude
/// from a Mono8 or Mono16 part or from the Y of ABCY16, confidence from a Confidence8 or
/// Confidence16 part. 8-bit samples become 16-bit ones (255 becomes 65535). Parts that are short or
/// have another size are left out; without depth nothing is written.
DepthUsed copy_depth(std::span<const GenicamPart> parts, Size size, const FloatDepth& floats,
                     const DepthBuffers& out);

}  // namespace mixrig::device
