// SPDX-License-Identifier: Apache-2.0
// Description and packet headers of USB ToF cameras, both directions (tof_usb_protocol.md).
#include <cmath>

#include <zlib.h>

#include "hal/wire/camera/tof_usb_decoder.h"

namespace mixrig::device {
namespace {

constexpr std::uint32_t kDescriptionMagic = 0x4D544F46, kPacketMagic = 0x4D544F50;
constexpr std::size_t kCrcAt = 36;
constexpr std::uint64_t kMostTime_us = 1ULL << 52;  // 142 years: fits 63 bits of nanoseconds

/// Little-endian numbers at fixed offsets of a block whose length the caller has checked.
struct Reader {
  std::span<const std::uint8_t> bytes;
  std::uint64_t at(std::size_t offset, int count) const {
    std::uint64_t value = 0;
    for (int i = count - 1; i >= 0; --i)
      value = value << 8 | bytes[offset + static_cast<std::size_t>(i)];
    return value;
  }
  std::uint16_t u16(std::size_t o) const { return static_cast<std::uint16_t>(at(o, 2)); }
  std::uint32_t u32(std::size_t o) const { return static_cast<std::uint32_t>(at(o, 4)); }
  bool crc_matches() const { return tof_crc32(bytes.first(kCrcAt)) == u32(kCrcAt); }
};

struct Writer {
  std::array<std::uint8_t, 40>& bytes;
  void put(std::size_t offset, std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i)
      bytes[offset + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  void put_crc() { put(kCrcAt, tof_crc32(std::span<const std::uint8_t>(bytes).first(kCrcAt)), 4); }
};

Error bad(const char* what) {
  return Error{ErrorCode::kDevice, std::string("ToF camera's description ") + what +
                                       ": the camera's firmware does not match this mixrig"};
}

}  // namespace

std::uint32_t tof_crc32(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, bytes.data(), bytes.size()));
}

Result<TofDescription> parse_tof_description(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kTofDescriptionBytes) return bad("is too short");
  const Reader in{bytes};
  if (in.u32(0) != kDescriptionMagic) return bad("has a wrong magic number");
  if (!in.crc_matches()) return bad("is damaged");
  if (in.u16(4) != 1) return bad("has another protocol version");
  TofDescription d;
  d.amplitude = (in.u16(6) & 1) != 0;
  d.depth.meaning = (in.u16(6) & 2) != 0 ? DepthMeaning::kDistance : DepthMeaning::kZ;
  d.size = {in.u16(8), in.u16(10)};
  if (d.size.empty() || d.size.width > kTofLongestSide || d.size.height > kTofLongestSide)
    return bad("has an impossible size");
  d.rate_hz = in.u32(12) / 1000.0;
  d.depth.metres_per_step = in.u32(16) * 1e-9;
  if (!(d.depth.metres_per_step > 0)) return bad("has a depth step of zero");
  d.depth.unknown_steps = {in.u16(20)};
  const auto fixed = [&](std::size_t o) { return static_cast<std::int32_t>(in.u32(o)) / 65536.0; };
  if (fixed(24) > 0) d.depth.intrinsics = DeviceIntrinsics{fixed(24), fixed(28), fixed(32)};
  return d;
}

std::optional<TofPacket> parse_tof_header(std::span<const std::uint8_t> bytes, Size size) {
  if (bytes.size() < kTofHeaderBytes) return std::nullopt;
  const Reader in{bytes};
  if (in.u32(0) != kPacketMagic || !in.crc_matches()) return std::nullopt;
  const std::uint16_t kind = in.u16(4);
  TofPacket p{.kind = static_cast<TofKind>(kind),
              .temperature = in.u16(6),
              .frame = in.u32(8),
              .first_row = in.u16(12),
              .rows = in.u16(14),
              .size = {in.u16(16), in.u16(18)},
              .payload_bytes = in.u32(20),
              .payload_crc = in.u32(32),
              .time_us = in.at(24, 8)};
  const bool valid = (kind == 1 || kind == 2) && p.size == size && p.rows > 0 &&
                     p.time_us < kMostTime_us && p.first_row + p.rows <= size.height &&
                     p.payload_bytes <= kTofMostPayload &&
                     p.payload_bytes == static_cast<std::uint32_t>(p.rows * size.width * 2);
  if (!valid) return std::nullopt;
  return p;
}

std::array<std::uint8_t, kTofDescriptionBytes> pack_tof_description(const TofDescription& d) {
  std::array<std::uint8_t, kTofDescriptionBytes> bytes{};
  Writer out{bytes};
  out.put(0, kDescriptionMagic, 4);
  out.put(4, 1, 2);
  out.put(6, (d.amplitude ? 1U : 0U) | (d.depth.meaning == DepthMeaning::kDistance ? 2U : 0U), 2);
  out.put(8, static_cast<std::uint64_t>(d.size.width), 2);
  out.put(10, static_cast<std::uint64_t>(d.size.height), 2);
  out.put(12, static_cast<std::uint64_t>(std::llround(d.rate_hz * 1000)), 4);
  out.put(16, static_cast<std::uint64_t>(std::llround(d.depth.metres_per_step * 1e9)), 4);
  out.put(20, static_cast<std::uint64_t>(d.depth.unknown_steps.front()), 2);
  if (d.depth.intrinsics) {
    const auto fixed = [](double v) { return static_cast<std::uint64_t>(std::llround(v * 65536)); };
    out.put(24, fixed(d.depth.intrinsics->focal_px), 4);
    out.put(28, fixed(d.depth.intrinsics->principal_x_px), 4);
    out.put(32, fixed(d.depth.intrinsics->principal_y_px), 4);
  }
  out.put_crc();
  return bytes;
}

std::array<std::uint8_t, kTofHeaderBytes> pack_tof_header(const TofPacket& p) {
  std::array<std::uint8_t, kTofHeaderBytes> bytes{};
  Writer out{bytes};
  out.put(0, kPacketMagic, 4);
  out.put(4, static_cast<std::uint64_t>(p.kind), 2);
  out.put(6, p.temperature, 2);
  out.put(8, p.frame, 4);
  out.put(12, static_cast<std::uint64_t>(p.first_row), 2);
  out.put(14, static_cast<std::uint64_t>(p.rows), 2);
  out.put(16, static_cast<std::uint64_t>(p.size.width), 2);
  out.put(18, static_cast<std::uint64_t>(p.size.height), 2);
  out.put(20, p.payload_bytes, 4);
  out.put(24, p.time_us, 8);
  out.put(32, p.payload_crc, 4);
  out.put_crc();
  return bytes;
}

}  // namespace mixrig::device
