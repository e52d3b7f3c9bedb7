// SPDX-License-Identifier: Apache-2.0
// Raw frames of a Kinect v2 made sample by sample, and packed from the published layout.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "hal/wire/camera/kinect2_raw.h"

namespace mixrig::test {

/// Code of 11 bits whose value is nearest to `value`, by search.
inline int kinect2_code(double value) {
  static const std::vector<int> values = [] {
    std::vector<int> v{0};
    for (int i = 0; i < 1023; ++i) v.push_back(v.back() + (1 << std::max(0, i / 128 - 1)));
    return v;
  }();
  int best = 0;
  for (int i = 1; i < 1024; ++i)
    if (std::abs(values[i] - std::abs(value)) < std::abs(values[best] - std::abs(value))) best = i;
  return value < 0 && best > 0 ? best + 1024 : best;
}

/// Raw data of ten pictures, at first zeros.
struct Kinect2Pictures {
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(device::kKinect2RawBytes);

  /// Sets a sample. x counts to the right as one sees the picture.
  void put(int picture, int x, int y, int code) {
    const int sent_x = 511 - x, row = y < 212 ? y : 635 - y;
    const long bit = ((picture * 424L + row) * 512 + sent_x / 4 + sent_x % 4 * 128) * 11;
    for (int i = 0; i < 11; ++i) {
      const auto mask = static_cast<std::uint8_t>(1U << ((bit + i) % 8));
      std::uint8_t& byte = bytes[static_cast<std::size_t>((bit + i) / 8)];
      byte = static_cast<std::uint8_t>((code >> i & 1) != 0 ? byte | mask : byte & ~mask);
    }
  }
};

/// One sub-packet: a picture and its footer.
inline std::vector<std::uint8_t> kinect2_packet(const std::uint8_t* picture, std::uint32_t number,
                                                std::uint32_t frame, std::uint32_t ticks) {
  std::vector<std::uint8_t> bytes(device::kKinect2PacketBytes);
  std::memcpy(bytes.data(), picture, device::kKinect2PictureBytes);
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i)
      bytes[device::kKinect2PictureBytes + at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  };
  put(8, ticks), put(12, frame), put(16, number), put(20, 298496);
  return bytes;
}

/// A colour packet of a JPEG file, with an exposure of 8 ms.
inline std::vector<std::uint8_t> kinect2_color_packet(const std::vector<std::uint8_t>& jpeg,
                                                      std::uint32_t frame, std::uint32_t ticks) {
  std::vector<std::uint8_t> bytes;
  const auto put = [&](std::uint32_t v) {
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
  };
  put(frame), put(0x42424242);
  bytes.insert(bytes.end(), jpeg.begin(), jpeg.end());
  const auto size = static_cast<std::uint32_t>(bytes.size() + 56);
  for (const std::uint32_t v : {0x39393939U, frame, 0U, 0U, 0U, ticks}) put(v);
  put(std::bit_cast<std::uint32_t>(8.0F)), put(0);
  put(0x42424242), put(size);
  for (int i = 0; i < 4; ++i) put(0);
  return bytes;
}

}  // namespace mixrig::test
