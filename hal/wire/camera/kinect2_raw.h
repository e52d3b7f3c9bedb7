// SPDX-License-Identifier: Apache-2.0
// Raw frames of a Kinect v2, as its isochronous packets and a take's files hold them
// (docs/reference/take.md), and the two tables that are needed to decode them. Pure functions that
// never read past a buffer. Layouts, sizes and numbers are facts published by libfreenect2
// (OpenKinect, at fd64c5d: protocol/response.h, the depth stream parser); the maker publishes none.
// The device mirrors its pictures left to right; pixels here are not mirrored, x points to the
// right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::device {

inline constexpr Size kKinect2Depth{512, 424};
inline constexpr int kKinect2Pictures = 10;  ///< pictures per frame
inline constexpr std::size_t kKinect2RowBytes = 512 * 11 / 8;
inline constexpr std::size_t kKinect2PictureBytes = kKinect2RowBytes * 424;
inline constexpr std::size_t kKinect2FooterBytes = 38 * 4;
inline constexpr std::size_t kKinect2PacketBytes = kKinect2PictureBytes + kKinect2FooterBytes;
inline constexpr std::size_t kKinect2RawBytes = kKinect2Pictures * kKinect2PictureBytes;
/// Phase angle of one step of the offset tables.
inline constexpr double kKinect2OffsetStep_rad = 0.000031 * 3.14159265358979323846;

/// Read four little-endian bytes at `at`, as an unsigned integer and as a float. Precondition: the
/// bytes exist.
std::uint32_t kinect2_word(std::span<const std::uint8_t> bytes, std::size_t at);
double kinect2_number(std::span<const std::uint8_t> bytes, std::size_t at);
/// Returns a kDevice error; `what` says what is wrong with the device's answer.
Error bad_kinect2_answer(const char* what);

/// Lens of the infrared camera: OpenCV's model, pixel (0,0) is the centre of the top-left pixel.
struct Kinect2Infrared {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3
};
/// Parses the lens table. Errors: kDevice; the line says what is wrong. parse_kinect2_offsets() has
/// the same errors.
Result<Kinect2Infrared> parse_kinect2_infrared(std::span<const std::uint8_t> bytes);

/// Phase offset of each pixel at the three frequencies, in steps of kKinect2OffsetStep_rad.
using Kinect2Offsets = std::array<Image<std::uint16_t>, 3>;
Result<Kinect2Offsets> parse_kinect2_offsets(std::span<const std::uint8_t> bytes);

/// Footer that follows each picture of a frame.
struct Kinect2Footer {
  std::uint32_t ticks = 0;  ///< device clock, 0.125 ms
  std::uint32_t frame = 0;
  int picture = 0;  ///< 0 to 9
};
/// Parses exactly kKinect2FooterBytes; empty unless length and picture number are possible.
std::optional<Kinect2Footer> parse_kinect2_footer(std::span<const std::uint8_t> bytes);

/// Value of a saturated sample.
inline constexpr std::int16_t kKinect2Saturated = 32767;
/// Unpacks row `y` (0 to 423) of a picture: samples of -16320 to 16320, or kKinect2Saturated.
/// Preconditions: `picture` has kKinect2PictureBytes, `out` holds 512 values.
void unpack_kinect2_row(std::span<const std::uint8_t> picture, int y, std::int16_t* out);

/// A raw frame, valid during the call.
struct Kinect2RawFrame {
  std::span<const std::uint8_t> pictures;  ///< kKinect2RawBytes: ten pictures in order
  std::uint32_t frame = 0, ticks = 0;      ///< ticks of the first picture received
  /// False: pictures are missing, and their bytes are from an earlier frame.
  bool whole = false;
};
using Kinect2RawSink = std::function<void(const Kinect2RawFrame&)>;

/// Assembles frames from the packets of the isochronous pipe. A frame is passed on when its tenth
/// picture arrives or, with some missing, when a picture of another frame does. Nothing allocates
/// after construction. For one thread.
class Kinect2DepthStream {
 public:
  Kinect2DepthStream();

  /// Takes one packet. An empty, lost or damaged packet (`good` false) ends a picture.
  void feed(std::span<const std::uint8_t> packet, bool good, const Kinect2RawSink& sink);
  void restart();
  /// Number of pictures with lost or damaged packets, a wrong length, or an invalid footer.
  std::uint64_t link_errors() const { return link_errors_; }

 private:
  void end_picture(std::span<const std::uint8_t> footer, const Kinect2RawSink& sink);
  void give(const Kinect2RawSink& sink);
  void skip_picture();

  std::vector<std::uint8_t> pending_, frame_;
  std::size_t count_ = 0;
  bool skipping_ = false;  ///< skips bytes up to the next boundary
  std::uint32_t got_ = 0;  ///< bit mask of received pictures
  std::uint32_t number_ = 0, ticks_ = 0;
  std::uint64_t link_errors_ = 0;
};

}  // namespace mixrig::device
