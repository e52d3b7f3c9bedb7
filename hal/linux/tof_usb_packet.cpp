// SPDX-License-Identifier: Apache-2.0
// Description and packet headers of USB ToF cameras, both directions (tof_usb_protocol.md).
#include <cmath>

#include "hal/linux/tof_usb_decoder.h"

namespace mixrig::device {
namespace {

constexpr std::uint32_t kDescriptionMagic = 0x4D544F46, kPacketMagic = 0x4D544F50;
constexpr std::size_t kCrcAt = 36;
constexpr std::uint64_t kMostTime_us = 1ULL << 52;  // 142 years: more would not fit nanoseconds

/// Table k: what a byte does to the register k bytes later.
using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr CrcTables make_crc_tables() {
  CrcTables tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) != 0 ? 0xEDB88320U : 0U);
    tables[0][i] = value;
  }
  for (std::size_t k = 1; k < tables.size(); ++k)
    for (std::size_t i = 0; i < 256; ++i) {
      const std::uint32_t before = tables[k - 1][i];
      tables[k][i] = (before >> 8) ^ tables[0][before & 0xFF];
    }
  return tables;
}

/// Little-endian numbers at fixed places of a block whose length the caller has checked.
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
  bool crc_holds() const { return crc32(bytes.first(kCrcAt)) == u32(kCrcAt); }
};

struct Writer {
  std::array<std::uint8_t, 40>& bytes;
  void put(std::size_t offset, std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i)
      bytes[offset + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  void seal() { put(kCrcAt, crc32(std::span<const std::uint8_t>(bytes).first(kCrcAt)), 4); }
};

Error bad(const char* what) {
  return Error{ErrorCode::kDevice, std::string("ToF camera's description ") + what +
                                       ": its firmware and this version do not fit"};
}

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  static constexpr CrcTables kTables = make_crc_tables();
  std::uint32_t crc = 0xFFFFFFFF;
  for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
    const auto byte = [&](std::size_t i) { return std::uint32_t{bytes[i]}; };
    const std::uint32_t first = crc ^ (byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24);
    crc = kTables[7][first & 0xFF] ^ kTables[6][first >> 8 & 0xFF] ^
          kTables[5][first >> 16 & 0xFF] ^ kTables[4][first >> 24] ^ kTables[3][byte(4)] ^
          kTables[2][byte(5)] ^ kTables[1][byte(6)] ^ kTables[0][byte(7)];
  }
  for (const std::uint8_t byte : bytes) crc = (crc >> 8) ^ kTables[0][(crc ^ byte) & 0xFF];
  return ~crc;
}

Result<TofDescription> parse_tof_description(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kTofDescriptionBytes) return bad("is too short");
  const Reader in{bytes};
  if (in.u32(0) != kDescriptionMagic) return bad("does not begin as it should");
  if (!in.crc_holds()) return bad("is damaged");
  if (in.u16(4) != 1) return bad("speaks of another protocol");
  TofDescription d;
  d.amplitude = (in.u16(6) & 1) != 0;
  d.depth.meaning = (in.u16(6) & 2) != 0 ? DepthMeaning::kDistance : DepthMeaning::kZ;
  d.size = {in.u16(8), in.u16(10)};
  if (d.size.empty() || d.size.width > kTofLongestSide || d.size.height > kTofLongestSide)
    return bad("names a size that cannot be");
  d.rate_hz = in.u32(12) / 1000.0;
  d.depth.metres_per_step = in.u32(16) * 1e-9;
  if (!(d.depth.metres_per_step > 0)) return bad("names a step of zero");
  d.depth.unknown_step = in.u16(20);
  const auto fixed = [&](std::size_t o) { return static_cast<std::int32_t>(in.u32(o)) / 65536.0; };
  if (fixed(24) > 0) d.depth.intrinsics = DeviceIntrinsics{fixed(24), fixed(28), fixed(32)};
  return d;
}

std::optional<TofPacket> parse_tof_header(std::span<const std::uint8_t> bytes, Size size) {
  if (bytes.size() < kTofHeaderBytes) return std::nullopt;
  const Reader in{bytes};
  if (in.u32(0) != kPacketMagic || !in.crc_holds()) return std::nullopt;
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
  const bool sound = (kind == 1 || kind == 2) && p.size == size && p.rows > 0 &&
                     p.time_us < kMostTime_us && p.first_row + p.rows <= size.height &&
                     p.payload_bytes <= kTofMostPayload &&
                     p.payload_bytes == static_cast<std::uint32_t>(p.rows * size.width * 2);
  if (!sound) return std::nullopt;
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
  out.put(20, static_cast<std::uint64_t>(d.depth.unknown_step), 2);
  if (d.depth.intrinsics) {
    const auto fixed = [](double v) { return static_cast<std::uint64_t>(std::llround(v * 65536)); };
    out.put(24, fixed(d.depth.intrinsics->focal_px), 4);
    out.put(28, fixed(d.depth.intrinsics->principal_x_px), 4);
    out.put(32, fixed(d.depth.intrinsics->principal_y_px), 4);
  }
  out.seal();
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
  out.seal();
  return bytes;
}

}  // namespace mixrig::device
