// SPDX-License-Identifier: Apache-2.0
// Buffers of GenICam cameras: declared geometry against delivered bytes, pure and bounded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/image.h"
#include "hal/device/frame.h"

namespace mixrig::device {

/// Pixel formats by their PFNC codes (GenICam Pixel Format Naming Convention).
namespace pfnc {
inline constexpr std::uint32_t kMono8 = 0x01080001, kMono16 = 0x01100007, kRgb8 = 0x02180014,
                               kBgr8 = 0x02180015, kBayerGr8 = 0x01080008, kBayerRg8 = 0x01080009,
                               kBayerGb8 = 0x0108000A, kBayerBg8 = 0x0108000B, kYuyv = 0x02100032,
                               kCoord3dC16 = 0x011000B8, kCoord3dAbc16 = 0x023000B9;
}  // namespace pfnc

/// kUnknown for formats that mixrig does not read. Both Coord3D formats become kDepth16.
PixelFormat format_of_pfnc(std::uint32_t code);
std::uint32_t pfnc_of_format(PixelFormat format);  ///< 0 where there is none

/// Bytes of a picture as the camera declares it; 0 for unknown codes and empty sizes.
std::size_t declared_bytes(std::uint32_t code, Size size);

/// Copies the declared picture, and only that, into `out`: some cameras send more than width *
/// height * bytes per pixel. Of Coord3D_ABC16 only C, the depth, is kept.
/// False where `data` is shorter than declared or `out` cannot hold it.
bool copy_picture(std::uint32_t code, Size size, std::span<const std::uint8_t> data,
                  std::span<std::uint8_t> out);

}  // namespace mixrig::device
