// SPDX-License-Identifier: Apache-2.0
// GLB files assembled byte by byte (glTF 2.0, section 4), without a glTF library.
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>

namespace mixrig::test {

inline std::string little_endian(std::uint32_t v) {
  return {static_cast<char>(v), static_cast<char>(v >> 8), static_cast<char>(v >> 16),
          static_cast<char>(v >> 24)};
}

inline std::string floats(std::initializer_list<float> values) {
  std::string out;
  for (const float value : values) {
    char bytes[4];
    std::memcpy(bytes, &value, 4);
    out.append(bytes, 4);
  }
  return out;
}

inline std::string shorts(std::initializer_list<int> values) {
  std::string out;
  for (const int value : values)
    out += {static_cast<char>(value & 255), static_cast<char>(value >> 8)};
  return out;
}

/// A GLB file of a JSON and a binary chunk, padded as the format requires.
inline std::string glb(std::string json, std::string binary) {
  while (json.size() % 4 != 0) json += ' ';
  while (binary.size() % 4 != 0) binary += '\0';
  std::string chunks = little_endian(static_cast<std::uint32_t>(json.size())) + "JSON" + json;
  if (!binary.empty())
    chunks +=
        little_endian(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
  return "glTF" + little_endian(2) + little_endian(static_cast<std::uint32_t>(12 + chunks.size())) +
         chunks;
}

}  // namespace mixrig::test
