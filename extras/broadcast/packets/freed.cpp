// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/freed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace mixrig::stream {
namespace {

constexpr std::byte kD1{0xD1};
constexpr std::int32_t kMost = 0x7FFFFF, kLeast = -0x800000;  // signed, 24 bits
constexpr double kRadPerStep = std::numbers::pi / 180 / 32768, kMetrePerStep = 1e-3 / 64;
// Offsets of the values in the packet.
constexpr std::size_t kPan = 2, kTilt = 5, kRoll = 8, kPosition = 11, kZoom = 20, kFocus = 23;
constexpr std::size_t kUser = 26, kChecksum = 28;

std::uint32_t unsigned_at(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint32_t>(bytes[at]) << 16 |
         std::to_integer<std::uint32_t>(bytes[at + 1]) << 8 |
         std::to_integer<std::uint32_t>(bytes[at + 2]);
}

std::int32_t signed_at(std::span<const std::byte> bytes, std::size_t at) {
  const auto value = static_cast<std::int32_t>(unsigned_at(bytes, at));
  return value > kMost ? value - 0x1000000 : value;
}

void put(std::uint32_t value, std::size_t at, std::span<std::byte> bytes) {
  for (std::size_t i = 0; i < 3; ++i)
    bytes[at + i] = static_cast<std::byte>(value >> (16 - 8 * i) & 0xFF);
}

/// Writes a signed 24-bit value in units of `step`, saturated; NaN becomes 0.
void put_signed(double value, double step, std::size_t at, std::span<std::byte> bytes) {
  const double steps = std::isnan(value) ? 0 : std::round(value / step);
  const double within = std::clamp(steps, double{kLeast}, double{kMost});
  put(static_cast<std::uint32_t>(static_cast<std::int32_t>(within)), at, bytes);
}

std::byte checksum_of(std::span<const std::byte> bytes) {
  unsigned sum = 0x40;
  for (std::size_t i = 0; i < kChecksum; ++i) sum -= std::to_integer<unsigned>(bytes[i]);
  return static_cast<std::byte>(sum & 0xFF);
}

}  // namespace

Result<FreeDPacket> parse_freed(std::span<const std::byte> bytes) {
  const auto wrong = [](const std::string& what) {
    return Error{ErrorCode::kData, "FreeD: " + what};
  };
  if (bytes.size() != kFreeDBytes)
    return wrong(fmt::format("{} bytes, a D1 packet has {}", bytes.size(), kFreeDBytes));
  if (bytes[0] != kD1)
    return wrong(
        fmt::format("a packet of kind {:02X}, D1 is read", std::to_integer<unsigned>(bytes[0])));
  if (bytes[kChecksum] != checksum_of(bytes))
    return wrong(fmt::format("the checksum is {:02X}, {:02X} was expected",
                             std::to_integer<unsigned>(bytes[kChecksum]),
                             std::to_integer<unsigned>(checksum_of(bytes))));
  FreeDPacket packet;
  packet.camera = std::to_integer<int>(bytes[1]);
  const auto value = [&](std::size_t at, double step) {
    const std::int32_t steps = signed_at(bytes, at);
    packet.saturated = packet.saturated || steps == kMost || steps == kLeast;
    return step * steps;
  };
  packet.pan_rad = value(kPan, kRadPerStep);
  packet.tilt_rad = value(kTilt, kRadPerStep);
  packet.roll_rad = value(kRoll, kRadPerStep);
  for (std::size_t i = 0; i < 3; ++i)
    packet.position_m[static_cast<Eigen::Index>(i)] = value(kPosition + 3 * i, kMetrePerStep);
  packet.zoom = unsigned_at(bytes, kZoom);
  packet.focus = unsigned_at(bytes, kFocus);
  packet.user = static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[kUser]) << 8 |
                                           std::to_integer<unsigned>(bytes[kUser + 1]));
  return packet;
}

std::array<std::byte, kFreeDBytes> freed_bytes(const FreeDPacket& packet) {
  std::array<std::byte, kFreeDBytes> bytes{};
  bytes[0] = kD1;
  bytes[1] = static_cast<std::byte>(packet.camera & 0xFF);
  put_signed(packet.pan_rad, kRadPerStep, kPan, bytes);
  put_signed(packet.tilt_rad, kRadPerStep, kTilt, bytes);
  put_signed(packet.roll_rad, kRadPerStep, kRoll, bytes);
  for (std::size_t i = 0; i < 3; ++i)
    put_signed(packet.position_m[static_cast<Eigen::Index>(i)], kMetrePerStep, kPosition + 3 * i,
               bytes);
  put(packet.zoom, kZoom, bytes);
  put(packet.focus, kFocus, bytes);
  bytes[kUser] = static_cast<std::byte>(packet.user >> 8);
  bytes[kUser + 1] = static_cast<std::byte>(packet.user & 0xFF);
  bytes[kChecksum] = checksum_of(bytes);
  return bytes;
}

}  // namespace mixrig::stream
