// SPDX-License-Identifier: Apache-2.0
// What a Kinect v2 says over USB: answers to commands, infrared sub-packets, colour packets. Pure
// and bounded. Layouts, sizes and numbers are facts published by libfreenect2 (OpenKinect, at
// fd64c5d: protocol/command.h, protocol/response.h, the two stream parsers); the maker publishes
// none. Pictures of the device are mirrored left to right; what is said here of pixels is as it is
// seen, x to the right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::device {

inline constexpr Size kKinect2Depth{512, 424}, kKinect2Color{1920, 1080};
inline constexpr int kKinect2Pictures = 10;  ///< of a frame
inline constexpr std::size_t kKinect2RowBytes = 512 * 11 / 8;
inline constexpr std::size_t kKinect2PictureBytes = kKinect2RowBytes * 424;
inline constexpr std::size_t kKinect2FooterBytes = 38 * 4;
inline constexpr std::size_t kKinect2PacketBytes = kKinect2PictureBytes + kKinect2FooterBytes;
inline constexpr std::size_t kKinect2RawBytes = kKinect2Pictures * kKinect2PictureBytes;
inline constexpr std::size_t kKinect2MostColor = std::size_t{2} << 20;  ///< of a colour packet
/// Phase of one step of the offset tables.
inline constexpr double kKinect2OffsetStep_rad = 0.000031 * 3.14159265358979323846;

// Commands: a header of 20 bytes and up to four parameters; the answer, where there is one, comes
// in one bulk transfer, then 16 bytes say that the command is complete.
enum class Kinect2Command : std::uint32_t {
  kFirmware = 0x02,
  kInitStreams = 0x09,
  kStop = 0x0A,
  kHardware = 0x14,
  kStatus = 0x16,
  kPage = 0x22,  ///< parameter: a Kinect2Page
  kSetStreaming = 0x2B,
  kSetMode = 0x4B,
};
enum class Kinect2Page : std::uint32_t { kSerial = 1, kPhaseOffsets, kInfrared, kColor };

struct Kinect2Request {
  Kinect2Command command = Kinect2Command::kStatus;
  std::array<std::uint32_t, 4> parameters{};
  int parameter_count = 0;
  std::uint32_t most_answer = 0, least_answer = 0;  ///< bytes; 0: there is none
};
std::vector<std::uint8_t> pack_kinect2_request(const Kinect2Request& request,
                                               std::uint32_t sequence);
/// The command's sequence number if these bytes say that a command is complete.
std::optional<std::uint32_t> parse_kinect2_complete(std::span<const std::uint8_t> bytes);

// Answers. Errors: kDevice; the line says what is wrong.
Result<std::string> parse_kinect2_serial(std::span<const std::uint8_t> bytes);
Result<std::string> parse_kinect2_firmware(std::span<const std::uint8_t> bytes);
Result<std::uint32_t> parse_kinect2_status(std::span<const std::uint8_t> bytes);

/// Lens of the infrared camera: OpenCV's model, pixel (0,0) is the centre of the top-left pixel.
struct Kinect2Infrared {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3
};
Result<Kinect2Infrared> parse_kinect2_infrared(std::span<const std::uint8_t> bytes);

/// The colour camera's pinhole. What else the answer holds (polynomials from depth to colour) is
/// not used: `calibrate rig` measures the rig.
struct Kinect2ColorLens {
  double f_px = 0, cx_px = 0, cy_px = 0;
};
Result<Kinect2ColorLens> parse_kinect2_color(std::span<const std::uint8_t> bytes);

/// Phase offset of each pixel at the three frequencies, in steps of kKinect2OffsetStep_rad.
using Kinect2Offsets = std::array<Image<std::uint16_t>, 3>;
Result<Kinect2Offsets> parse_kinect2_offsets(std::span<const std::uint8_t> bytes);

/// Behind each picture of a frame.
struct Kinect2Footer {
  std::uint32_t ticks = 0;  ///< device clock, 0.125 ms
  std::uint32_t frame = 0;
  int picture = 0;  ///< 0 to 9
};
/// Of exactly kKinect2FooterBytes; empty unless length and picture are possible.
std::optional<Kinect2Footer> parse_kinect2_footer(std::span<const std::uint8_t> bytes);

/// What a sample says when the pixel is saturated.
inline constexpr std::int16_t kKinect2Saturated = 32767;
/// Samples of row `y` (0 to 423) of a picture, -16320 to 16320 or kKinect2Saturated.
/// Preconditions: `picture` has kKinect2PictureBytes, `out` 512 values.
void unpack_kinect2_row(std::span<const std::uint8_t> picture, int y, std::int16_t* out);

/// A colour packet: one JPEG file, 1920x1080, mirrored.
struct Kinect2ColorPacket {
  std::span<const std::uint8_t> jpeg;
  std::uint32_t frame = 0;
  std::uint32_t ticks = 0;  ///< device clock, 0.125 ms
  double exposure_ms = 0;   ///< 0 where it is not plausible
};
/// Whether the bytes end as a packet does.
bool ends_kinect2_color(std::span<const std::uint8_t> bytes);
/// A whole packet; empty where any part contradicts another.
std::optional<Kinect2ColorPacket> parse_kinect2_color_packet(std::span<const std::uint8_t> bytes);

}  // namespace mixrig::device
