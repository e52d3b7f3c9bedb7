// SPDX-License-Identifier: Apache-2.0
// Checksums of the wire (CRC-16) and of images (CRC-32), four bits per step with 16-entry tables:
// the firmware is freestanding and small, so zlib (which the host uses) is not available to it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace mixrig::protocol {

namespace detail {
constexpr std::array<std::uint16_t, 16> make_crc16_table() {
  std::array<std::uint16_t, 16> table{};
  for (unsigned i = 0; i < 16; ++i) {
    unsigned c = i << 12;
    for (int bit = 0; bit < 4; ++bit) c = (c & 0x8000u) ? (c << 1) ^ 0x1021u : c << 1;
    table[i] = static_cast<std::uint16_t>(c);
  }
  return table;
}
constexpr std::array<std::uint32_t, 16> make_crc32_table() {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 4; ++bit) c = (c & 1u) ? (c >> 1) ^ 0xEDB88320u : c >> 1;
    table[i] = c;
  }
  return table;
}
inline constexpr auto kCrc16Table = make_crc16_table();
inline constexpr auto kCrc32Table = make_crc32_table();
}  // namespace detail

/// CRC-16/CCITT-FALSE (poly 0x1021, start 0xFFFF, not reflected); "123456789" gives 0x29B1.
constexpr std::uint16_t crc16(std::span<const std::uint8_t> data) {
  unsigned c = 0xFFFF;
  for (const unsigned byte : data) {
    c = ((c << 4) & 0xFFFFu) ^ detail::kCrc16Table[(c >> 12) ^ (byte >> 4)];
    c = ((c << 4) & 0xFFFFu) ^ detail::kCrc16Table[(c >> 12) ^ (byte & 15u)];
  }
  return static_cast<std::uint16_t>(c);
}

/// CRC-32 of IEEE 802.3, continued from `before`; "123456789" gives 0xCBF43926.
constexpr std::uint32_t crc32(std::span<const std::uint8_t> data, std::uint32_t before = 0) {
  std::uint32_t c = ~before;
  for (const std::uint32_t byte : data) {
    c = detail::kCrc32Table[(c ^ byte) & 15u] ^ (c >> 4);
    c = detail::kCrc32Table[(c ^ (byte >> 4)) & 15u] ^ (c >> 4);
  }
  return ~c;
}

}  // namespace mixrig::protocol
