// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/kinect2_protocol.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace mixrig::device {
namespace {

constexpr std::uint32_t kRequestMagic = 0x06022009, kCompleteMagic = 0x0A6FE000;
constexpr std::uint32_t kColorHeader = 0x42424242, kColorFooter = 0x39393939;
constexpr std::size_t kColorFooterBytes = 56, kColorHeaderBytes = 8;
constexpr std::size_t kOffsetsHeader = 32;
constexpr std::size_t kOffsetsTable = 2 * (std::size_t{512} * 424 + 2);
constexpr std::size_t kInfraredBytes = 92, kColorLensBytes = 1 + 4 * 25;

std::uint32_t u32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}
double f32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<double>(std::bit_cast<float>(u32(bytes, at)));
}

Error bad_answer(const char* what) {
  return Error{ErrorCode::kDevice, std::string("Kinect v2: its answer ") + what +
                                       ": plug it in again; if it stays, this firmware is unknown"};
}

/// What a sample of 11 bits says: sign, exponent of three bits, mantissa of seven.
constexpr std::array<std::int16_t, 2048> make_samples() {
  std::array<std::int16_t, 2048> table{};
  for (int code = 0; code < 1024; ++code) {
    const int exponent = code >> 7, mantissa = code & 127;
    const int value = exponent == 0 ? mantissa : (128 + mantissa) << (exponent - 1);
    table[code] = static_cast<std::int16_t>(value);
    table[code + 1024] = static_cast<std::int16_t>(-value);
  }
  table[1024] = kKinect2Saturated;  // minus zero
  return table;
}
constexpr std::array<std::int16_t, 2048> kSamples = make_samples();

}  // namespace

std::vector<std::uint8_t> pack_kinect2_request(const Kinect2Request& request,
                                               std::uint32_t sequence) {
  std::vector<std::uint8_t> bytes;
  const auto put = [&](std::uint32_t v) {
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
  };
  put(kRequestMagic), put(sequence), put(request.most_answer);
  put(static_cast<std::uint32_t>(request.command)), put(0);
  for (int i = 0; i < request.parameter_count; ++i)
    put(request.parameters[static_cast<std::size_t>(i)]);
  return bytes;
}

std::optional<std::uint32_t> parse_kinect2_complete(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != 16 || u32(bytes, 0) != kCompleteMagic) return std::nullopt;
  return u32(bytes, 4);
}

Result<std::string> parse_kinect2_serial(std::span<const std::uint8_t> bytes) {
  std::string serial;  // one character in two bytes, ended by a zero
  for (std::size_t i = 0; i < bytes.size() && bytes[i] != 0; i += 2) {
    if (bytes[i] < 0x21 || bytes[i] > 0x7E || serial.size() >= 64)
      return bad_answer("is no serial number");
    serial += static_cast<char>(bytes[i]);
  }
  if (serial.empty()) return bad_answer("has an empty serial number");
  return serial;
}

Result<std::string> parse_kinect2_firmware(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMain = 3 * 16;  // the fourth of several parts
  if (bytes.size() < kMain + 12) return bad_answer("of firmware versions is too short");
  const std::uint32_t version = u32(bytes, kMain);
  return std::to_string(version >> 16) + "." + std::to_string(version & 0xFFFF) + "." +
         std::to_string(u32(bytes, kMain + 4)) + "." + std::to_string(u32(bytes, kMain + 8));
}

Result<std::uint32_t> parse_kinect2_status(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4) return bad_answer("of its status is too short");
  return u32(bytes, 0);
}

Result<Kinect2Infrared> parse_kinect2_infrared(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kInfraredBytes) return bad_answer("of infrared parameters is too short");
  const auto number = [&](std::size_t i) { return f32(bytes, 4 * i); };
  // Numbers: fx fy ? cx cy k1 k2 p1 p2 k3. Its pixel centres are at halves, its picture mirrored.
  Kinect2Infrared lens{number(0),
                       number(1),
                       kKinect2Depth.width - 0.5 - number(3),
                       number(4) - 0.5,
                       {number(5), number(6), number(7), -number(8), number(9)}};
  bool possible = lens.fx_px > 100 && lens.fx_px < 2000 && lens.fy_px > 100 && lens.fy_px < 2000 &&
                  lens.cx_px > 0 && lens.cx_px < kKinect2Depth.width && lens.cy_px > 0 &&
                  lens.cy_px < kKinect2Depth.height;
  for (const double k : lens.distortion) possible = possible && std::abs(k) < 10;
  if (!possible) return bad_answer("has impossible infrared parameters");
  return lens;
}

Result<Kinect2ColorLens> parse_kinect2_color(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kColorLensBytes) return bad_answer("of colour parameters is too short");
  const Kinect2ColorLens lens{f32(bytes, 1), kKinect2Color.width - 0.5 - f32(bytes, 5),
                              f32(bytes, 9) - 0.5};
  const bool possible = lens.f_px > 300 && lens.f_px < 5000 && lens.cx_px > 0 &&
                        lens.cx_px < kKinect2Color.width && lens.cy_px > 0 &&
                        lens.cy_px < kKinect2Color.height;
  if (!possible) return bad_answer("has impossible colour parameters");
  return lens;
}

Result<Kinect2Offsets> parse_kinect2_offsets(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kOffsetsHeader + 3 * kOffsetsTable)
    return bad_answer("of phase offsets is too short");
  Kinect2Offsets offsets;
  for (std::size_t f = 0; f < offsets.size(); ++f) {
    offsets[f].reset(kKinect2Depth);
    const auto table = bytes.subspan(kOffsetsHeader + f * kOffsetsTable + 2, kOffsetsTable - 4);
    for (int y = 0; y < kKinect2Depth.height; ++y)
      for (int x = 0; x < kKinect2Depth.width; ++x) {
        const std::size_t at =
            2 * (static_cast<std::size_t>(y) * kKinect2Depth.width + (kKinect2Depth.width - 1 - x));
        offsets[f].row(y)[x] = static_cast<std::uint16_t>(table[at] | table[at + 1] << 8);
      }
  }
  return offsets;
}

std::optional<Kinect2Footer> parse_kinect2_footer(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != kKinect2FooterBytes) return std::nullopt;
  const std::uint32_t picture = u32(bytes, 16);
  if (picture >= kKinect2Pictures || u32(bytes, 20) != kKinect2PictureBytes) return std::nullopt;
  return Kinect2Footer{u32(bytes, 8), u32(bytes, 12), static_cast<int>(picture)};
}

void unpack_kinect2_row(std::span<const std::uint8_t> picture, int y, std::int16_t* out) {
  constexpr int kHalf = kKinect2Depth.height / 2, kLast = kKinect2Depth.height - 1;
  const int sent = y < kHalf ? y : kHalf + kLast - y;
  const std::uint8_t* in = picture.data() + static_cast<std::size_t>(sent) * kKinect2RowBytes;
  // Samples come every fourth column together, from the right: eight of them are in 11 bytes.
  for (int part = 0; part < 4; ++part)
    for (int i = 0; i < 128; i += 8, in += 11) {
      std::uint64_t low = 0, high = 0;
      for (int b = 0; b < 8; ++b) low |= static_cast<std::uint64_t>(in[b]) << (8 * b);
      for (int b = 0; b < 6; ++b) high |= static_cast<std::uint64_t>(in[5 + b]) << (8 * b);
      std::int16_t* to = out + 511 - part - 4 * i;
      for (int k = 0; k < 4; ++k) to[-4 * k] = kSamples[low >> (11 * k) & 2047];
      for (int k = 4; k < 8; ++k) to[-4 * k] = kSamples[high >> (11 * k - 40) & 2047];
    }
}

bool ends_kinect2_color(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kColorHeaderBytes + kColorFooterBytes) return false;
  const auto footer = bytes.last(kColorFooterBytes);
  return u32(footer, 0) == kColorFooter && u32(footer, 32) == kColorHeader;
}

std::optional<Kinect2ColorPacket> parse_kinect2_color_packet(std::span<const std::uint8_t> bytes) {
  if (!ends_kinect2_color(bytes) || u32(bytes, 4) != kColorHeader) return std::nullopt;
  const auto footer = bytes.last(kColorFooterBytes);
  auto jpeg =
      bytes.subspan(kColorHeaderBytes, bytes.size() - kColorHeaderBytes - kColorFooterBytes);
  const std::uint32_t filler = u32(footer, 8);
  if (u32(footer, 36) != bytes.size() || u32(footer, 4) != u32(bytes, 0) || filler > jpeg.size())
    return std::nullopt;
  jpeg = jpeg.first(jpeg.size() - filler);
  // The file's end, FF D9, is within three bytes of padding.
  for (int padding = 0; padding < 4 && jpeg.size() >= 2; ++padding) {
    if (jpeg[jpeg.size() - 2] == 0xFF && jpeg.back() == 0xD9) {
      const double exposure_ms = f32(footer, 24);
      return Kinect2ColorPacket{jpeg, u32(bytes, 0), u32(footer, 20),
                                exposure_ms > 0 && exposure_ms < 1000 ? exposure_ms : 0};
    }
    jpeg = jpeg.first(jpeg.size() - 1);
  }
  return std::nullopt;
}

}  // namespace mixrig::device
