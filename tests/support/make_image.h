// SPDX-License-Identifier: Apache-2.0
// Firmware images for tests: valid header and vectors, random contents.
#pragma once

#include <cstring>
#include <random>
#include <vector>

#include "firmware/protocol/image_header.h"
#include "firmware/protocol/messages.h"

namespace mixrig::device {

inline void stamp(std::vector<std::uint8_t>& image, protocol::ImageHeader header) {
  header.size = static_cast<std::uint32_t>(image.size());
  std::memcpy(image.data() + protocol::kHeaderOffset, &header, sizeof header);
  header.crc = protocol::image_crc(image);
  std::memcpy(image.data() + protocol::kHeaderOffset, &header, sizeof header);
}

inline protocol::ImageHeader good_header() {
  protocol::ImageHeader header;
  header.magic = protocol::kImageMagic;
  header.table_hash = protocol::kTableHash;
  header.board = protocol::kBoardF405;
  header.version[1] = 1;
  return header;
}

inline std::vector<std::uint8_t> make_image(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> image(size);
  for (auto& byte : image) byte = static_cast<std::uint8_t>(random());
  const std::uint32_t vectors[2] = {0x2001C000, protocol::kFlashBase + 0x221};
  std::memcpy(image.data(), vectors, sizeof vectors);
  stamp(image, good_header());
  return image;
}

}  // namespace mixrig::device
