// SPDX-License-Identifier: Apache-2.0
// An answer of a RealSense D400's hardware monitor, byte by byte from librealsense's structures.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include <zlib.h>

namespace mixrig::test {

/// An answer with the table of coefficients: entry `index` has fx, fy, ppx, ppy, the others are 0.
inline std::vector<std::uint8_t> realsense_answer(int index, std::array<float, 4> k) {
  std::vector<std::uint8_t> body(560);  // 4 matrices, baseline, model, 88, 16 entries, 64
  std::memcpy(body.data() + 240 + 16 * index, k.data(), sizeof k);
  std::vector<std::uint8_t> answer(1024);
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
      answer[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> 8 * i);
  };
  put(0, 0x15);
  answer[4] = 2;   // version 2.0, big-endian
  answer[6] = 25;  // coefficients
  put(8, static_cast<std::uint32_t>(body.size()));
  put(16, static_cast<std::uint32_t>(::crc32(0, body.data(), static_cast<unsigned>(body.size()))));
  std::memcpy(answer.data() + 20, body.data(), body.size());
  put(1020, static_cast<std::uint32_t>(16 + body.size()));
  return answer;
}

}  // namespace mixrig::test
