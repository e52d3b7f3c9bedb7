// SPDX-License-Identifier: Apache-2.0
// FreeD, the protocol of camera heads and lens encoders: its D1 packet, 29 bytes in one datagram.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "hal/base/result.h"

namespace mixrig::stream {

inline constexpr std::size_t kFreeDBytes = 29;

/// Pose and lens of one camera. Zero pan looks along +y; to the right, up and, seen from behind,
/// clockwise are positive. x right, y ahead, z up.
struct FreeDPacket {
  int camera = 0;  ///< 0..255
  double pan_rad = 0, tilt_rad = 0, roll_rad = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  std::uint32_t zoom = 0, focus = 0;  ///< counts of the encoders, 24 bits
  std::uint16_t user = 0;
  /// True where an angle or position is at the end of its 24 bits; the true one may lie beyond (256
  /// degrees, 131 m).
  bool saturated = false;
};

/// Reads a datagram. Pure. Errors: kData for another length or kind, or a wrong checksum.
Result<FreeDPacket> parse_freed(std::span<const std::byte> bytes);

/// Writes the packet's bytes. Values out of range are saturated; camera, zoom and focus are cut to
/// their bits.
std::array<std::byte, kFreeDBytes> freed_bytes(const FreeDPacket& packet);

}  // namespace mixrig::stream
