// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/realsense_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <string>

#include "firmware/protocol/crc.h"

namespace mixrig::device {
namespace {

constexpr std::uint16_t kMonitorMagic = 0xCDAB;
constexpr std::uint32_t kGetCalibration = 0x15, kCoefficientsTable = 25;
constexpr std::size_t kOpcodeBytes = 4, kHeaderBytes = 16;
// Position of the field with the length of the answer after its opcode.
constexpr std::size_t kLengthAt = kRealSenseMonitorBytes - 4;
// Before the rectified sizes the table has two matrices of the cameras, two rotations, baseline,
// model and 88 reserved bytes.
constexpr std::size_t kRectifiedAt = 4 * 9 * 4 + 4 + 4 + 88, kRectifiedBytes = 16;
constexpr auto kRectifiedSizes = std::to_array<Size>({{1920, 1080},
                                                      {1280, 720},
                                                      {640, 480},
                                                      {848, 480},
                                                      {640, 360},
                                                      {424, 240},
                                                      {320, 240},
                                                      {480, 270},
                                                      {1280, 800},
                                                      {960, 540},
                                                      {0, 0},
                                                      {0, 0},
                                                      {640, 400}});

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 |
         static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}
double float_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<double>(std::bit_cast<float>(word_at(bytes, at)));
}

Error bad_table(const std::string& what) {
  return Error{ErrorCode::kData,
               "the calibration table of the camera " + what + ": plug the camera in again"};
}

/// Returns the table's bytes after its header.
Result<std::span<const std::uint8_t>> checked_table(std::span<const std::uint8_t> answer) {
  if (answer.size() != kRealSenseMonitorBytes) return bad_table("is not 1024 bytes long");
  if (word_at(answer, 0) != kGetCalibration)
    return bad_table("was refused (answer " + std::to_string(word_at(answer, 0)) + ")");
  const std::size_t length = word_at(answer, kLengthAt);
  if (length < kHeaderBytes || length > kLengthAt - kOpcodeBytes)
    return bad_table("has a length that does not fit");
  const auto table = answer.subspan(kOpcodeBytes, length);
  if ((table[2] | table[3] << 8) != static_cast<int>(kCoefficientsTable))
    return bad_table("is another one");
  const std::size_t bytes = word_at(table, 4);
  if (bytes > length - kHeaderBytes) return bad_table("is cut off");
  const auto body = table.subspan(kHeaderBytes, bytes);
  if (protocol::crc32(body) != word_at(table, 12)) return bad_table("is damaged (CRC)");
  return body;
}

}  // namespace

RealSenseMessage realsense_calibration_request() {
  RealSenseMessage request{};
  constexpr std::uint16_t kBytes = 20;  // bytes of opcode and four parameters
  request[0] = kBytes;
  request[2] = kMonitorMagic & 0xFF;
  request[3] = kMonitorMagic >> 8;
  request[4] = kGetCalibration;
  request[8] = kCoefficientsTable;
  return request;
}

Result<DeviceIntrinsics> parse_realsense_calibration(std::span<const std::uint8_t> answer,
                                                     Size size) {
  MIXRIG_ASSIGN(const auto table, checked_table(answer));
  const auto found = size.empty() ? kRectifiedSizes.end()
                                  : std::find(kRectifiedSizes.begin(), kRectifiedSizes.end(), size);
  const std::size_t at =
      kRectifiedAt + kRectifiedBytes * static_cast<std::size_t>(found - kRectifiedSizes.begin());
  if (found == kRectifiedSizes.end() || at + kRectifiedBytes > table.size())
    return Error{ErrorCode::kUnsupported,
                 "the calibration table of the camera has no pictures of " +
                     std::to_string(size.width) + "x" + std::to_string(size.height) +
                     ": give another size_px"};
  const DeviceIntrinsics found_k{float_at(table, at), float_at(table, at + 8),
                                 float_at(table, at + 12)};
  const auto inside = [](double value, int limit) { return value > 0 && value < limit; };
  if (!(found_k.focal_px > 0) || !std::isfinite(found_k.focal_px) ||
      !inside(found_k.principal_x_px, size.width) || !inside(found_k.principal_y_px, size.height))
    return bad_table("has no values for this size");
  return found_k;
}

bool is_realsense_d400(std::uint16_t usb_vendor, std::uint16_t usb_product) {
  constexpr std::uint16_t kProducts[] = {0x0AD1, 0x0AD2, 0x0AD3, 0x0AD4,
                                         0x0B07, 0x0B3A, 0x0B5C, 0x0B5B};
  return usb_vendor == 0x8086 &&
         std::find(std::begin(kProducts), std::end(kProducts), usb_product) != std::end(kProducts);
}

}  // namespace mixrig::device
