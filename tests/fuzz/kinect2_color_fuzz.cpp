// SPDX-License-Identifier: Apache-2.0
// Bulk transfers of a Kinect v2's colour pipe, split anywhere. The first byte sets the length of
// transfers and whether the magic numbers and lengths of a packet are filled in.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "extras/kinect2/kinect2_protocol.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(kinect2_color) {
  using namespace mixrig::device;
  if (size == 0) return 0;
  std::vector<std::uint8_t> bytes(data + 1, data + size);
  const std::size_t n = bytes.size();
  const auto put = [&](std::size_t at, std::uint32_t v) {
    for (std::size_t b = 0; b < 4; ++b) bytes[at + b] = static_cast<std::uint8_t>(v >> (8 * b));
  };
  if ((*data & 1) != 0 && n >= 70) {
    put(4, 0x42424242), put(n - 56, 0x39393939), put(n - 24, 0x42424242);
    put(n - 20, static_cast<std::uint32_t>(n));
    if ((*data & 2) != 0) std::copy_n(bytes.begin(), 4, bytes.end() - 52);
    if ((*data & 4) != 0) put(n - 48, bytes[10] % 8);
    if ((*data & 8) != 0) bytes[n - 58] = 0xFF, bytes[n - 57] = 0xD9;
  }
  Kinect2ColorStream stream;
  const std::size_t step = 1 + (*data >> 4) * 16U;
  for (std::size_t at = 0; at < n; at += step)
    stream.feed(std::span(bytes).subspan(at, std::min(step, n - at)),
                [&](const Kinect2ColorPacket& packet) {
                  const auto& jpeg = packet.jpeg;
                  if (jpeg.size() < 2 || jpeg.size() > n || jpeg.back() != 0xD9) std::abort();
                });
  return 0;
}
