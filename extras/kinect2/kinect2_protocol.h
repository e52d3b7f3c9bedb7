// SPDX-License-Identifier: Apache-2.0
// USB messages of a Kinect v2 besides its raw frames (hal/wire/camera/kinect2_raw.h): answers to
// commands, colour packets. Pure and bounded. Layouts, sizes and numbers are facts published by
// libfreenect2 (OpenKinect, at fd64c5d: protocol/command.h, protocol/response.h, the colour stream
// parser); the maker publishes none. Pictures of the device are mirrored left to right; comments
// here describe pixels as seen, x to the right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.h"
#include "hal/wire/camera/kinect2_raw.h"

namespace mixrig::device {

inline constexpr Size kKinect2Color{1920, 1080};
inline constexpr std::size_t kKinect2MostColor = std::size_t{2} << 20;  ///< largest colour packet

// A command is a header of 20 bytes and up to four parameters. Its answer, if any, comes in one
// bulk transfer; then 16 bytes say that the command is complete.
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
  std::uint32_t most_answer = 0, least_answer = 0;  ///< bytes; 0: no answer
};
std::vector<std::uint8_t> pack_kinect2_request(const Kinect2Request& request,
                                               std::uint32_t sequence);
/// Sequence number of the command that these bytes report as complete; nullopt for other bytes.
std::optional<std::uint32_t> parse_kinect2_complete(std::span<const std::uint8_t> bytes);

// Parse answers. Errors: kDevice; the line says what is wrong.
Result<std::string> parse_kinect2_serial(std::span<const std::uint8_t> bytes);
Result<std::string> parse_kinect2_firmware(std::span<const std::uint8_t> bytes);
Result<std::uint32_t> parse_kinect2_status(std::span<const std::uint8_t> bytes);

/// Pinhole of the colour camera. Other contents of the answer (polynomials from depth to colour)
/// are not used: `calibrate rig` measures the rig.
struct Kinect2ColorLens {
  double f_px = 0, cx_px = 0, cy_px = 0;
};
Result<Kinect2ColorLens> parse_kinect2_color(std::span<const std::uint8_t> bytes);

/// A colour packet: one JPEG file, 1920x1080, mirrored.
struct Kinect2ColorPacket {
  std::span<const std::uint8_t> jpeg;
  std::uint32_t frame = 0;
  std::uint32_t ticks = 0;  ///< device clock, 0.125 ms
  double exposure_ms = 0;   ///< 0 where it is not plausible
};
/// Whether the bytes end like a colour packet.
bool ends_kinect2_color(std::span<const std::uint8_t> bytes);
/// Parses a whole packet; nullopt where its parts contradict each other.
std::optional<Kinect2ColorPacket> parse_kinect2_color_packet(std::span<const std::uint8_t> bytes);

/// Joins transfers of the colour pipe to packets. Nothing allocates after construction. For one
/// thread.
class Kinect2ColorStream {
 public:
  Kinect2ColorStream();

  void feed(std::span<const std::uint8_t> transfer,
            const std::function<void(const Kinect2ColorPacket&)>& sink);
  void restart() { count_ = 0, skipping_ = false; }
  std::uint64_t link_errors() const { return link_errors_; }

 private:
  std::vector<std::uint8_t> pending_;
  std::size_t count_ = 0;
  bool skipping_ = false;  ///< skips the rest of a packet that is too long
  std::uint64_t link_errors_ = 0;
};

}  // namespace mixrig::device
