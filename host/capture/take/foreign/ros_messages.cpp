// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/foreign/ros_messages.h"

#include <bit>
#include <cmath>

namespace mixrig::take {
namespace {

constexpr std::uint32_t kMostSide = 16384;
constexpr std::uint32_t kMostTransforms = 4096;

RosHeader read_header(RosReader& from) {
  RosHeader header;
  from.u32();  // sequence
  const std::uint32_t seconds = from.u32(), nanoseconds = from.u32();
  header.time_s = seconds + 1e-9 * nanoseconds;
  header.frame = from.text();
  if (header.frame.starts_with("/")) header.frame.erase(0, 1);
  return header;
}

/// Height before width, as the messages have it. Sides that no picture has become 0.
Size read_size(RosReader& from) {
  const std::uint32_t height = from.u32(), width = from.u32();
  if (height > kMostSide || width > kMostSide) return {};
  return {static_cast<int>(width), static_cast<int>(height)};
}

/// Whether all rows are there, each with `bytes` a pixel.
bool is_whole(const RosPicture& picture, std::size_t bytes) {
  const std::size_t row = bytes * static_cast<std::size_t>(picture.size_px.width);
  return !picture.size_px.empty() && picture.row_bytes >= row &&
         picture.data.size() >=
             static_cast<std::size_t>(picture.row_bytes) * (picture.size_px.height - 1) + row;
}

std::uint32_t sample(const std::uint8_t* at, int bytes, bool is_big_endian) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i)
    value |= static_cast<std::uint32_t>(at[i]) << (8 * (is_big_endian ? bytes - 1 - i : i));
  return value;
}

std::uint16_t steps_of(float metres, double unit_m) {
  const double steps = metres / unit_m;
  return steps > 0 && steps < 65535 ? static_cast<std::uint16_t>(std::lround(steps)) : 0;
}

struct ColorEncoding {
  const char* name;
  std::size_t bytes, red, green, blue;
};
constexpr ColorEncoding kColors[] = {{"rgb8", 3, 0, 1, 2},  {"bgr8", 3, 2, 1, 0},
                                     {"8UC3", 3, 2, 1, 0},  {"rgba8", 4, 0, 1, 2},
                                     {"bgra8", 4, 2, 1, 0}, {"8UC4", 4, 2, 1, 0}};

}  // namespace

std::span<const std::uint8_t> RosReader::take(std::size_t count) {
  if (count > rest_.size()) ok_ = false, rest_ = {}, count = 0;
  const auto taken = rest_.first(count);
  rest_ = rest_.subspan(count);
  return taken;
}

std::uint8_t RosReader::u8() {
  const auto byte = take(1);
  return byte.empty() ? std::uint8_t{0} : byte[0];
}

std::uint32_t RosReader::u32() {
  const auto bytes = take(4);
  return bytes.empty() ? 0 : sample(bytes.data(), 4, false);
}

double RosReader::f64() {
  const std::uint64_t low = u32(), high = u32();
  return std::bit_cast<double>(high << 32U | low);
}

std::string RosReader::text() {
  const auto bytes = block();
  return {bytes.begin(), bytes.end()};
}

std::optional<RosPicture> parse_picture(std::span<const std::uint8_t> bytes, bool is_compressed) {
  RosReader from(bytes);
  RosPicture picture;
  picture.header = read_header(from);
  if (!is_compressed) picture.size_px = read_size(from);
  picture.encoding = from.text();
  if (!is_compressed) picture.is_big_endian = from.u8() != 0, picture.row_bytes = from.u32();
  picture.data = from.block();
  return from.ok() ? std::optional(std::move(picture)) : std::nullopt;
}

std::optional<RosCamera> parse_camera_info(std::span<const std::uint8_t> bytes) {
  RosReader from(bytes);
  RosCamera camera;
  camera.header = read_header(from);
  camera.size_px = read_size(from);
  camera.lens = from.text();
  constexpr std::uint32_t kMostNumbers = 14;
  const std::uint32_t count = from.u32();
  if (count > kMostNumbers) return std::nullopt;
  for (std::uint32_t i = 0; i < count; ++i) camera.d.push_back(from.f64());
  for (double& value : camera.k) value = from.f64();
  return from.ok() ? std::optional(std::move(camera)) : std::nullopt;
}

std::optional<std::vector<RosTransform>> parse_transforms(std::span<const std::uint8_t> bytes) {
  RosReader from(bytes);
  std::vector<RosTransform> transforms;
  const std::uint32_t count = from.u32();
  if (count > kMostTransforms) return std::nullopt;
  for (std::uint32_t i = 0; i < count && from.ok(); ++i) {
    RosTransform one;
    one.parent = read_header(from).frame;
    one.child = from.text();
    if (one.child.starts_with("/")) one.child.erase(0, 1);
    for (int axis = 0; axis < 3; ++axis) one.parent_from_child.translation_m[axis] = from.f64();
    Eigen::Quaterniond& q = one.parent_from_child.rotation;
    q.x() = from.f64(), q.y() = from.f64(), q.z() = from.f64(), q.w() = from.f64();
    if (!one.parent_from_child.translation_m.allFinite() || !(std::abs(q.norm() - 1) < 0.01))
      return std::nullopt;
    q.normalize();
    transforms.push_back(std::move(one));
  }
  return from.ok() ? std::optional(std::move(transforms)) : std::nullopt;
}

bool is_depth(const RosPicture& picture) {
  const std::string& e = picture.encoding;
  return e == "16UC1" || e == "mono16" || e == "32FC1" ||
         e.find("compressedDepth") != std::string::npos;
}

bool decode_color(const RosPicture& picture, Image<Rgb8>& image) {
  for (const ColorEncoding& encoding : kColors) {
    if (picture.encoding != encoding.name) continue;
    if (!is_whole(picture, encoding.bytes)) return false;
    if (image.size() != picture.size_px) image.reset(picture.size_px);
    for (int y = 0; y < image.height(); ++y) {
      const std::uint8_t* at =
          picture.data.data() + static_cast<std::size_t>(picture.row_bytes) * y;
      for (int x = 0; x < image.width(); ++x, at += encoding.bytes)
        image.row(y)[x] = {at[encoding.red], at[encoding.green], at[encoding.blue]};
    }
    return true;
  }
  return false;
}

bool decode_depth(const RosPicture& picture, double unit_m, Image<std::uint16_t>& steps) {
  const bool is_float = picture.encoding == "32FC1";
  const int bytes = is_float ? 4 : 2;
  if (!is_whole(picture, static_cast<std::size_t>(bytes))) return false;
  if (steps.size() != picture.size_px) steps.reset(picture.size_px);
  for (int y = 0; y < steps.height(); ++y) {
    const std::uint8_t* at = picture.data.data() + static_cast<std::size_t>(picture.row_bytes) * y;
    for (int x = 0; x < steps.width(); ++x, at += bytes) {
      const std::uint32_t value = sample(at, bytes, picture.is_big_endian);
      steps.row(y)[x] = is_float ? steps_of(std::bit_cast<float>(value), unit_m)
                                 : static_cast<std::uint16_t>(value);
    }
  }
  return true;
}

}  // namespace mixrig::take
