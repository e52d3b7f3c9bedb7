// SPDX-License-Identifier: Apache-2.0
// The header inside a firmware image, and the checksum that host and firmware both verify.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/protocol/crc.h"

namespace mixrig::protocol {

inline constexpr std::uint32_t kFlashBase = 0x08000000;
inline constexpr std::size_t kHeaderOffset = 0x200;  ///< after the vector table
inline constexpr std::size_t kVectorBlock = 256;  ///< written last: without vectors nothing boots
inline constexpr std::size_t kMaxImage = 128u * 1024;     ///< sectors 0..4
inline constexpr std::uint32_t kImageMagic = 0x4754584D;  ///< "MXTG"
inline constexpr std::uint16_t kBoardF405 = 405;

/// Header at kHeaderOffset, little-endian; `crc` covers the image without `size` and `crc`.
struct ImageHeader {
  std::uint32_t magic = 0;
  std::uint32_t size = 0;  ///< bytes of the whole image, a multiple of 4
  std::uint32_t crc = 0;
  std::uint32_t table_hash = 0;
  std::uint16_t board = 0;
  std::uint8_t version[3] = {};
  std::uint8_t reserved = 0;
};
static_assert(sizeof(ImageHeader) == 22 + 2);
inline constexpr std::size_t kSizeField = kHeaderOffset + 4;
inline constexpr std::size_t kAfterCrc = kHeaderOffset + 12;

/// CRC of an image of at least kHeaderOffset + sizeof(ImageHeader) bytes.
constexpr std::uint32_t image_crc(std::span<const std::uint8_t> image) {
  return crc32(image.subspan(kAfterCrc), crc32(image.first(kSizeField)));
}

}  // namespace mixrig::protocol
