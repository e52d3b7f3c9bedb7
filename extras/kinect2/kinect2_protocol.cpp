// SPDX-License-Identifier: Apache-2.0
#include "extras/kinect2/kinect2_protocol.h"

#include <algorithm>

namespace mixrig::device {
namespace {

constexpr std::uint32_t kRequestMagic = 0x06022009, kCompleteMagic = 0x0A6FE000;
constexpr std::uint32_t kColorHeader = 0x42424242, kColorFooter = 0x39393939;
constexpr std::size_t kColorFooterBytes = 56, kColorHeaderBytes = 8;
constexpr std::size_t kColorLensBytes = 1 + 4 * 25;

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
  if (bytes.size() != 16 || kinect2_word(bytes, 0) != kCompleteMagic) return std::nullopt;
  return kinect2_word(bytes, 4);
}

Result<std::string> parse_kinect2_serial(std::span<const std::uint8_t> bytes) {
  std::string serial;  // one character in two bytes, ended by a zero
  for (std::size_t i = 0; i < bytes.size() && bytes[i] != 0; i += 2) {
    if (bytes[i] < 0x21 || bytes[i] > 0x7E || serial.size() >= 64)
      return bad_kinect2_answer("is no serial number");
    serial += static_cast<char>(bytes[i]);
  }
  if (serial.empty()) return bad_kinect2_answer("has an empty serial number");
  return serial;
}

Result<std::string> parse_kinect2_firmware(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMain = 3 * 16;  // the fourth of several parts
  if (bytes.size() < kMain + 12) return bad_kinect2_answer("of firmware versions is too short");
  const std::uint32_t version = kinect2_word(bytes, kMain);
  return std::to_string(version >> 16) + "." + std::to_string(version & 0xFFFF) + "." +
         std::to_string(kinect2_word(bytes, kMain + 4)) + "." +
         std::to_string(kinect2_word(bytes, kMain + 8));
}

Result<std::uint32_t> parse_kinect2_status(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4) return bad_kinect2_answer("of its status is too short");
  return kinect2_word(bytes, 0);
}

Result<Kinect2ColorLens> parse_kinect2_color(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kColorLensBytes)
    return bad_kinect2_answer("of colour parameters is too short");
  const Kinect2ColorLens lens{kinect2_number(bytes, 1),
                              kKinect2Color.width - 0.5 - kinect2_number(bytes, 5),
                              kinect2_number(bytes, 9) - 0.5};
  const bool possible = lens.f_px > 300 && lens.f_px < 5000 && lens.cx_px > 0 &&
                        lens.cx_px < kKinect2Color.width && lens.cy_px > 0 &&
                        lens.cy_px < kKinect2Color.height;
  if (!possible) return bad_kinect2_answer("has impossible colour parameters");
  return lens;
}

bool ends_kinect2_color(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kColorHeaderBytes + kColorFooterBytes) return false;
  const auto footer = bytes.last(kColorFooterBytes);
  return kinect2_word(footer, 0) == kColorFooter && kinect2_word(footer, 32) == kColorHeader;
}

std::optional<Kinect2ColorPacket> parse_kinect2_color_packet(std::span<const std::uint8_t> bytes) {
  if (!ends_kinect2_color(bytes) || kinect2_word(bytes, 4) != kColorHeader) return std::nullopt;
  const auto footer = bytes.last(kColorFooterBytes);
  auto jpeg =
      bytes.subspan(kColorHeaderBytes, bytes.size() - kColorHeaderBytes - kColorFooterBytes);
  const std::uint32_t filler = kinect2_word(footer, 8);
  if (kinect2_word(footer, 36) != bytes.size() ||
      kinect2_word(footer, 4) != kinect2_word(bytes, 0) || filler > jpeg.size())
    return std::nullopt;
  jpeg = jpeg.first(jpeg.size() - filler);
  // The file's end, FF D9, is within three bytes of padding.
  for (int padding = 0; padding < 4 && jpeg.size() >= 2; ++padding) {
    if (jpeg[jpeg.size() - 2] == 0xFF && jpeg.back() == 0xD9) {
      const double exposure_ms = kinect2_number(footer, 24);
      return Kinect2ColorPacket{jpeg, kinect2_word(bytes, 0), kinect2_word(footer, 20),
                                exposure_ms > 0 && exposure_ms < 1000 ? exposure_ms : 0};
    }
    jpeg = jpeg.first(jpeg.size() - 1);
  }
  return std::nullopt;
}

Kinect2ColorStream::Kinect2ColorStream() : pending_(kKinect2MostColor) {}

void Kinect2ColorStream::feed(std::span<const std::uint8_t> transfer,
                              const std::function<void(const Kinect2ColorPacket&)>& sink) {
  if (skipping_) {
    skipping_ = !ends_kinect2_color(transfer);
    return;
  }
  if (count_ + transfer.size() > pending_.size()) {
    ++link_errors_;
    count_ = 0;
    skipping_ = !ends_kinect2_color(transfer);
    return;
  }
  std::copy(transfer.begin(), transfer.end(),
            pending_.begin() + static_cast<std::ptrdiff_t>(count_));
  count_ += transfer.size();
  const auto all = std::span<const std::uint8_t>(pending_).first(count_);
  if (!ends_kinect2_color(all)) return;
  count_ = 0;
  if (const auto packet = parse_kinect2_color_packet(all))
    sink(*packet);
  else
    ++link_errors_;
}

}  // namespace mixrig::device
