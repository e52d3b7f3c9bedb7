// SPDX-License-Identifier: Apache-2.0
// PNG files assembled from the specification (RFC 2083, RFC 1950) with stored deflate blocks,
// without a library: readers are tested independently of our encoder.
#pragma once

#include <cstdint>
#include <string>

namespace mixrig::test {

inline std::string big_endian(std::uint32_t v) {
  return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
          static_cast<char>(v)};
}

inline std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = ~0U;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xEDB88320U & (0U - (crc & 1U)));
  }
  return ~crc;
}

inline std::string chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data +
         big_endian(crc32(type + data));
}

/// A zlib stream of one stored block; `raw` holds fewer than 65536 bytes.
inline std::string stored_zlib(const std::string& raw) {
  std::uint32_t a = 1, b = 0;
  for (const char byte : raw) {
    a = (a + static_cast<std::uint8_t>(byte)) % 65521U;
    b = (b + a) % 65521U;
  }
  const auto low = static_cast<char>(raw.size() & 255U), high = static_cast<char>(raw.size() >> 8);
  std::string out("\x78\x01\x01", 3);
  out += {low, high, static_cast<char>(~low), static_cast<char>(~high)};
  return out + raw + big_endian((b << 16) | a);
}

/// `scanlines`: for each row a filter byte 0 and the pixels. `extra`: chunks before the pixels.
inline std::string hand_png(std::uint32_t width, std::uint32_t height, int bit_depth,
                            int color_type, const std::string& scanlines,
                            const std::string& extra = {}) {
  const std::string header = big_endian(width) + big_endian(height) + static_cast<char>(bit_depth) +
                             static_cast<char>(color_type) + std::string(3, '\0');
  return std::string("\x89PNG\r\n\x1a\n", 8) + chunk("IHDR", header) + extra +
         chunk("IDAT", stored_zlib(scanlines)) + chunk("IEND", "");
}

/// The bytes of a list of values 0..255.
inline std::string bytes_of(std::initializer_list<int> values) {
  std::string out;
  for (const int value : values) out += static_cast<char>(value);
  return out;
}

}  // namespace mixrig::test
