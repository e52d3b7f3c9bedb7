// SPDX-License-Identifier: Apache-2.0
// The header of an OpenTrackIO datagram. Private to this module.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace mixrig::stream::opentrack_bytes {

inline constexpr std::array<char, 4> kMagic{'O', 'T', 'r', 'k'};
inline constexpr std::size_t kEncodingAt = 5, kSequenceAt = 6, kOffsetAt = 8, kLengthAt = 12;
inline constexpr std::size_t kFletcherAt = 14;
inline constexpr std::uint16_t kLastBit = 0x8000;

inline void put_big(std::uint32_t value, std::size_t count, std::byte* to) {
  for (std::size_t i = 0; i < count; ++i)
    to[i] = static_cast<std::byte>(value >> (8 * (count - 1 - i)) & 0xFF);
}

inline std::uint32_t get_big(std::span<const std::byte> bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  return value;
}

/// Fletcher's checksum modulo 256, over all bytes except the checksum's own.
inline std::uint16_t fletcher16(std::span<const std::byte> datagram) {
  unsigned sum = 0, sums = 0;
  for (std::size_t i = 0; i < datagram.size(); ++i) {
    if (i == kFletcherAt || i == kFletcherAt + 1) continue;
    sum = (sum + std::to_integer<unsigned>(datagram[i])) % 256;
    sums = (sums + sum) % 256;
  }
  return static_cast<std::uint16_t>(sums << 8 | sum);
}

}  // namespace mixrig::stream::opentrack_bytes
