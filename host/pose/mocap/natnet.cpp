// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/natnet.h"

#include <bit>
#include <cmath>
#include <cstring>

namespace mixrig::stream {
namespace {

static_assert(std::endian::native == std::endian::little, "the wire is little-endian");

/// Reads values in order; past the end of the bytes all values read as zero.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }

  template <typename T>
  T take() {
    T value{};
    if (!has(sizeof value)) return value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  void skip(std::size_t count) {
    if (has(count)) at_ += count;
  }
  void skip_text() {
    while (ok_ && take<char>() != '\0') {
    }
  }
  /// Reads a count of items of at least `size` bytes each.
  std::size_t count(std::size_t size) {
    const auto n = take<std::int32_t>();
    if (n < 0 || static_cast<std::size_t>(n) > left() / size) ok_ = false;
    return ok_ ? static_cast<std::size_t>(n) : 0;
  }
  Eigen::Vector3d vector() {
    const double x = take<float>(), y = take<float>(), z = take<float>();
    return {x, y, z};
  }

 private:
  bool has(std::size_t count) {
    if (ok_ && count <= left()) return true;
    ok_ = false;
    return false;
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

/// Reads a section: its count, in newer versions its size in bytes, then its items, which `body`
/// reads.
template <typename Body>
void section(Reader& reader, NatNetVersion version, std::size_t item_size, Body&& body) {
  const std::size_t count = reader.count(item_size);
  if (!version.at_least(4, 1)) return body(count);
  const auto size = reader.take<std::int32_t>();
  if (size < 0) return reader.skip(reader.left() + 1);
  const std::size_t begin = reader.at();
  body(count);
  const std::size_t used = reader.at() - begin;
  // A newer server sends more bytes than `body` reads. Fewer: `body` read past the section's end.
  if (used > static_cast<std::size_t>(size)) return reader.skip(reader.left() + 1);
  reader.skip(static_cast<std::size_t>(size) - used);
}

constexpr std::size_t kPointSize = 12, kBodySize = 38, kMarkerSize = 26;

void skip_marker_sets(Reader& reader, std::size_t count) {
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    reader.skip_text();
    reader.skip(reader.count(kPointSize) * kPointSize);
  }
}

NatNetBody read_body(Reader& reader) {
  NatNetBody body;
  body.id = reader.take<std::int32_t>();
  body.world_from_body.translation_m = reader.vector();
  const Eigen::Vector3d q = reader.vector();
  const double w = reader.take<float>();
  body.mean_error_m = reader.take<float>();
  body.tracked = (reader.take<std::int16_t>() & 1) != 0;
  const Eigen::Quaterniond rotation(w, q.x(), q.y(), q.z());
  constexpr double kUnit = 1e-3;
  if (!body.world_from_body.translation_m.allFinite() || !(std::abs(rotation.norm() - 1) < kUnit) ||
      !std::isfinite(body.mean_error_m))
    return {body.id, {}, 0, false};
  body.world_from_body.rotation = rotation.normalized();
  return body;
}

NatNetMarker read_marker(Reader& reader) {
  NatNetMarker marker;
  const auto id = reader.take<std::uint32_t>();
  marker.body_id = static_cast<int>(id >> 16);
  marker.marker_id = static_cast<int>(id & 0xffff);
  marker.position_m = reader.vector();
  reader.take<float>();  // size
  marker.occluded = (reader.take<std::int16_t>() & 1) != 0;
  marker.residual_m = reader.take<float>();
  if (!marker.position_m.allFinite()) marker.position_m.setZero(), marker.occluded = true;
  return marker;
}

void skip_skeletons(Reader& reader, std::size_t count) {
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    reader.skip(4);
    reader.skip(reader.count(kBodySize) * kBodySize);
  }
}

/// Skips force plates and devices: channels of floats.
void skip_analog(Reader& reader, std::size_t count) {
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    reader.skip(4);
    const std::size_t channels = reader.count(4);
    for (std::size_t c = 0; c < channels && reader.ok(); ++c) reader.skip(reader.count(4) * 4);
  }
}

Error broken(const std::string& what) { return {ErrorCode::kFormat, "NatNet packet: " + what}; }

}  // namespace

Result<NatNetPacket> next_packet(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  NatNetPacket packet;
  packet.kind = reader.take<std::uint16_t>();
  const std::size_t payload = reader.take<std::uint16_t>();
  if (!reader.ok()) return broken("shorter than its header");
  if (payload > reader.left())
    return broken("cut off, " + std::to_string(payload) + " bytes announced, " +
                  std::to_string(reader.left()) + " there");
  packet.payload = bytes.subspan(4, payload);
  packet.size = 4 + payload;
  return packet;
}

Result<NatNetVersion> parse_server_info(std::span<const std::byte> payload) {
  Reader reader(payload);
  reader.skip(256 + 4);  // name of the program and its version
  NatNetVersion version;
  version.major = reader.take<std::uint8_t>();
  version.minor = reader.take<std::uint8_t>();
  if (!reader.ok()) return broken("server info is cut off");
  if (!version.at_least(3, 0))
    return Error{ErrorCode::kUnsupported, "NatNet " + std::to_string(version.major) + "." +
                                              std::to_string(version.minor) +
                                              " is too old: 3.0 or newer is needed"};
  return version;
}

Result<NatNetFrame> parse_frame(std::span<const std::byte> payload, NatNetVersion version) {
  Reader reader(payload);
  NatNetFrame frame;
  frame.number = reader.take<std::int32_t>();
  const char* at = "marker sets";
  const auto read = [&](const char* name, std::size_t item_size, auto&& body) {
    if (!reader.ok()) return;
    at = name;
    section(reader, version, item_size, body);
  };
  read("marker sets", 5, [&](std::size_t n) { skip_marker_sets(reader, n); });
  read("other markers", kPointSize, [&](std::size_t n) { reader.skip(n * kPointSize); });
  read("rigid bodies", kBodySize, [&](std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) frame.bodies.push_back(read_body(reader));
  });
  read("skeletons", 8, [&](std::size_t n) { skip_skeletons(reader, n); });
  // Assets came with the section sizes; they are skipped.
  if (version.at_least(4, 1)) read("assets", 1, [](std::size_t) {});
  read("labelled markers", kMarkerSize, [&](std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) frame.markers.push_back(read_marker(reader));
  });
  read("force plates", 8, [&](std::size_t n) { skip_analog(reader, n); });
  read("devices", 8, [&](std::size_t n) { skip_analog(reader, n); });
  if (reader.ok()) at = "suffix";
  reader.skip(8);  // time code
  frame.time_s = reader.take<double>();
  if (!reader.ok()) return broken(std::string("the section of ") + at + " is cut off or broken");
  if (!std::isfinite(frame.time_s)) return broken("the time stamp is not finite");
  return frame;
}

Result<std::vector<NatNetFrame>> parse_capture(std::span<const std::byte> bytes,
                                               NatNetVersion version) {
  std::vector<NatNetFrame> frames;
  for (int number = 1; !bytes.empty(); ++number) {
    const auto numbered = [&](const Error& error) {
      return Error{error.code, "packet " + std::to_string(number) + ": " + error.context};
    };
    const auto packet = next_packet(bytes);
    if (!packet) return numbered(packet.error());
    bytes = bytes.subspan(packet->size);
    if (packet->kind == static_cast<std::uint16_t>(NatNetKind::kServerInfo)) {
      const auto stated = parse_server_info(packet->payload);
      if (!stated) return numbered(stated.error());
      version = *stated;
    } else if (packet->kind == static_cast<std::uint16_t>(NatNetKind::kFrame)) {
      auto frame = parse_frame(packet->payload, version);
      if (!frame) return numbered(frame.error());
      frames.push_back(std::move(*frame));
    }
  }
  return frames;
}

}  // namespace mixrig::stream
