// SPDX-License-Identifier: Apache-2.0
// Messages of ROS 1 about cameras, as serialised: little-endian, texts and arrays behind their
// length. Private to this module.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"

namespace mixrig::take {

/// Reads values one after the other; past the end it gives zeros and is no longer ok().
class RosReader {
 public:
  explicit RosReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}
  bool ok() const { return ok_; }
  bool at_end() const { return rest_.empty(); }
  std::span<const std::uint8_t> take(std::size_t count);
  std::uint8_t u8();
  std::uint32_t u32();
  double f64();
  /// The bytes behind a length of 32 bits.
  std::span<const std::uint8_t> block() { return take(u32()); }
  std::string text();

 private:
  std::span<const std::uint8_t> rest_;
  bool ok_ = true;
};

struct RosHeader {
  double time_s = 0;
  std::string frame;
};
/// sensor_msgs/Image, or sensor_msgs/CompressedImage, which has no size and its format as encoding.
struct RosPicture {
  RosHeader header;
  Size size_px;
  std::string encoding;
  bool is_big_endian = false;
  std::uint32_t row_bytes = 0;
  std::span<const std::uint8_t> data;
};
struct RosCamera {
  RosHeader header;
  Size size_px;
  std::string lens;
  std::vector<double> d;
  std::array<double, 9> k{};
};
struct RosTransform {
  std::string parent, child;
  geometry::Pose parent_from_child;
};

/// Parse one message; nullopt where it is cut off. Pure.
std::optional<RosPicture> parse_picture(std::span<const std::uint8_t> bytes, bool is_compressed);
std::optional<RosCamera> parse_camera_info(std::span<const std::uint8_t> bytes);
std::optional<std::vector<RosTransform>> parse_transforms(std::span<const std::uint8_t> bytes);

/// Whether the picture is of depth, by its encoding.
bool is_depth(const RosPicture& picture);
/// Decodes an uncompressed colour picture; false for an encoding that is not known, or too few
/// bytes.
bool decode_color(const RosPicture& picture, Image<Rgb8>& image);
/// Decodes uncompressed depth to steps: 16 bits as they are, floats in metres by `unit_m`, what is
/// no distance as 0.
bool decode_depth(const RosPicture& picture, double unit_m, Image<std::uint16_t>& steps);

}  // namespace mixrig::take
