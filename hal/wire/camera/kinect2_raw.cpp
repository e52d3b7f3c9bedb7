// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/kinect2_raw.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

namespace mixrig::device {
namespace {

constexpr std::size_t kOffsetsHeader = 32;
constexpr std::size_t kOffsetsTable = 2 * (std::size_t{512} * 424 + 2);
constexpr std::size_t kInfraredBytes = 92;

/// Makes the table of sample values: 11 bits are a sign, an exponent of three bits and a mantissa
/// of seven.
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

std::uint32_t kinect2_word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

double kinect2_number(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<double>(std::bit_cast<float>(kinect2_word(bytes, at)));
}

Error bad_kinect2_answer(const char* what) {
  return Error{ErrorCode::kDevice, std::string("Kinect v2: its answer ") + what +
                                       ": plug it in again; if it stays, this firmware is unknown"};
}

Result<Kinect2Infrared> parse_kinect2_infrared(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kInfraredBytes)
    return bad_kinect2_answer("of infrared parameters is too short");
  const auto number = [&](std::size_t i) { return kinect2_number(bytes, 4 * i); };
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
  if (!possible) return bad_kinect2_answer("has impossible infrared parameters");
  return lens;
}

Result<Kinect2Offsets> parse_kinect2_offsets(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kOffsetsHeader + 3 * kOffsetsTable)
    return bad_kinect2_answer("of phase offsets is too short");
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
  const std::uint32_t picture = kinect2_word(bytes, 16);
  if (picture >= kKinect2Pictures || kinect2_word(bytes, 20) != kKinect2PictureBytes)
    return std::nullopt;
  return Kinect2Footer{kinect2_word(bytes, 8), kinect2_word(bytes, 12), static_cast<int>(picture)};
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

Kinect2DepthStream::Kinect2DepthStream()
    : pending_(kKinect2PacketBytes), frame_(kKinect2RawBytes) {}

void Kinect2DepthStream::restart() {
  count_ = 0;
  skipping_ = false;
  got_ = 0;
}

void Kinect2DepthStream::skip_picture() {
  if (!skipping_) ++link_errors_;
  skipping_ = true;
  count_ = 0;
}

void Kinect2DepthStream::feed(std::span<const std::uint8_t> packet, bool good,
                              const Kinect2RawSink& sink) {
  if (!good) return skip_picture();
  if (packet.empty()) {
    if (count_ > 0) ++link_errors_;  // a picture that ended too early
    count_ = 0;
    skipping_ = false;
    return;
  }
  if (skipping_) return;
  if (count_ + packet.size() > kKinect2PacketBytes) return skip_picture();
  std::copy(packet.begin(), packet.end(), pending_.begin() + static_cast<std::ptrdiff_t>(count_));
  count_ += packet.size();
  if (count_ < kKinect2PacketBytes) return;
  count_ = 0;
  end_picture(std::span<const std::uint8_t>(pending_).subspan(kKinect2PictureBytes), sink);
}

void Kinect2DepthStream::end_picture(std::span<const std::uint8_t> bytes,
                                     const Kinect2RawSink& sink) {
  const auto footer = parse_kinect2_footer(bytes);
  if (!footer) return skip_picture();
  if (got_ != 0 && footer->frame != number_) give(sink);
  if (got_ == 0) number_ = footer->frame, ticks_ = footer->ticks;
  const auto at =
      static_cast<std::ptrdiff_t>(static_cast<std::size_t>(footer->picture) * kKinect2PictureBytes);
  std::copy_n(pending_.begin(), kKinect2PictureBytes, frame_.begin() + at);
  got_ |= 1U << footer->picture;
  if (got_ == (1U << kKinect2Pictures) - 1) give(sink);
}

void Kinect2DepthStream::give(const Kinect2RawSink& sink) {
  sink({frame_, number_, ticks_, got_ == (1U << kKinect2Pictures) - 1});
  got_ = 0;
}

}  // namespace mixrig::device
