// SPDX-License-Identifier: Apache-2.0
// The byte stream of a USB ToF camera, for tests and emulators.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "hal/wire/camera/tof_usb_decoder.h"

namespace mixrig::test {

/// Depth value of a pixel in frame `frame`: never 0 (unknown), different in every frame.
inline std::uint16_t tof_step(std::uint32_t frame, int x, int y) {
  return static_cast<std::uint16_t>(
      1 + (500 + 7 * frame + static_cast<std::uint32_t>(x) + 11 * static_cast<std::uint32_t>(y)) %
              60000);
}

inline std::vector<std::uint8_t> tof_packet(const device::TofDescription& d, device::TofKind kind,
                                            std::uint32_t frame, int first_row, int rows,
                                            std::uint64_t time_us) {
  std::vector<std::uint8_t> payload;
  for (int y = first_row; y < first_row + rows; ++y)
    for (int x = 0; x < d.size.width; ++x) {
      const std::uint16_t step = kind == device::TofKind::kDistance ? tof_step(frame, x, y) : 1000;
      payload.push_back(static_cast<std::uint8_t>(step & 0xFF));
      payload.push_back(static_cast<std::uint8_t>(step >> 8));
    }
  const auto header =
      device::pack_tof_header({.kind = kind,
                               .temperature = 4150,
                               .frame = frame,
                               .first_row = first_row,
                               .rows = rows,
                               .size = d.size,
                               .payload_bytes = static_cast<std::uint32_t>(payload.size()),
                               .payload_crc = device::tof_crc32(payload),
                               .time_us = time_us});
  payload.insert(payload.begin(), header.begin(), header.end());
  return payload;
}

/// The packets of one frame.
inline std::vector<std::vector<std::uint8_t>> tof_frame(const device::TofDescription& d,
                                                        std::uint32_t frame,
                                                        std::uint64_t time_us) {
  const int rows_each = std::max(1, 16384 / (2 * d.size.width));
  std::vector<std::vector<std::uint8_t>> packets;
  for (const auto kind : {device::TofKind::kDistance, device::TofKind::kAmplitude}) {
    if (kind == device::TofKind::kAmplitude && !d.amplitude) break;
    for (int row = 0; row < d.size.height; row += rows_each)
      packets.push_back(
          tof_packet(d, kind, frame, row, std::min(rows_each, d.size.height - row), time_us));
  }
  return packets;
}

}  // namespace mixrig::test
