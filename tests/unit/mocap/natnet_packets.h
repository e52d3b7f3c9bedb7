// SPDX-License-Identifier: Apache-2.0
// Writes NatNet packets, independently of the parser.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "host/pose/mocap/natnet.h"

namespace mixrig::stream {

/// Appends values as little-endian bytes.
class PacketWriter {
 public:
  template <typename T>
  PacketWriter& put(T value) {
    const auto* begin = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), begin, begin + sizeof value);
    return *this;
  }
  PacketWriter& text(const std::string& words) {
    for (char c : words) put(c);
    return put('\0');
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }
  /// The bytes behind a packet's header.
  std::vector<std::byte> packet(std::uint16_t kind) const {
    PacketWriter whole;
    whole.put(kind).put(static_cast<std::uint16_t>(bytes_.size()));
    whole.bytes_.insert(whole.bytes_.end(), bytes_.begin(), bytes_.end());
    return whole.bytes_;
  }

 private:
  std::vector<std::byte> bytes_;
};

/// A frame with one body (id 3, at x, turned 180 degrees about z) and one labelled marker;
/// `sized`: with the sections' sizes and assets of 4.1.
inline PacketWriter frame_with_body(int number, float x, double time_s, bool sized) {
  PacketWriter w;
  const auto section = [&](std::int32_t count, const PacketWriter& body) {
    w.put(count);
    if (sized) w.put(static_cast<std::int32_t>(body.bytes().size()));
    for (std::byte b : body.bytes()) w.put(b);
  };
  w.put(std::int32_t{number});
  section(1, PacketWriter().text("all").put(std::int32_t{1}).put(1.f).put(2.f).put(3.f));
  section(1, PacketWriter().put(7.f).put(8.f).put(9.f));
  section(1, PacketWriter()
                 .put(std::int32_t{3})
                 .put(x)
                 .put(0.5f)
                 .put(0.25f)
                 .put(0.f)
                 .put(0.f)
                 .put(1.f)
                 .put(0.f)
                 .put(0.0005f)
                 .put(std::int16_t{1}));
  section(0, {});
  if (sized) section(1, PacketWriter().put(std::int32_t{99}).put(1.f));  // an asset, skipped
  section(1, PacketWriter()
                 .put(std::uint32_t{3u << 16 | 2u})
                 .put(x)
                 .put(1.f)
                 .put(2.f)
                 .put(0.02f)
                 .put(std::int16_t{11})
                 .put(0.0002f));
  section(1, PacketWriter()
                 .put(std::int32_t{1})
                 .put(std::int32_t{1})
                 .put(std::int32_t{2})
                 .put(0.f)
                 .put(1.f));
  section(0, {});
  w.put(std::uint32_t{0}).put(std::uint32_t{0}).put(time_s);
  w.put(std::uint64_t{1}).put(std::uint64_t{2}).put(std::uint64_t{3});
  if (sized) w.put(std::uint32_t{0}).put(std::uint32_t{0});
  w.put(std::int16_t{0}).put(std::int32_t{0});
  return w;
}

/// A whole packet of NatNet 3.0 with the frame's labelled markers, and nothing else in it.
inline std::vector<std::byte> packet_of_markers(const NatNetFrame& frame) {
  PacketWriter w;
  w.put(std::int32_t{frame.number});
  for (int section = 0; section < 4; ++section) w.put(std::int32_t{0});
  w.put(static_cast<std::int32_t>(frame.markers.size()));
  for (const NatNetMarker& marker : frame.markers) {
    w.put(static_cast<std::uint32_t>(marker.body_id) << 16 |
          static_cast<std::uint32_t>(marker.marker_id));
    for (int axis = 0; axis < 3; ++axis) w.put(static_cast<float>(marker.position_m[axis]));
    w.put(0.02F).put(static_cast<std::int16_t>(marker.occluded ? 1 : 0)).put(0.0F);
  }
  for (int section = 0; section < 2; ++section) w.put(std::int32_t{0});
  w.put(std::uint32_t{0}).put(std::uint32_t{0}).put(frame.time_s);
  for (int stamp = 0; stamp < 3; ++stamp) w.put(std::uint64_t{0});
  w.put(std::int16_t{0}).put(std::int32_t{0});
  return w.packet(7);
}

}  // namespace mixrig::stream
