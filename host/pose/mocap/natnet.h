// SPDX-License-Identifier: Apache-2.0
// NatNet, the protocol of OptiTrack's Motive: frames of rigid bodies and markers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.h"
#include "host/math/geometry/pose.h"

namespace mixrig::stream {

/// Version of the protocol, 3.0 or later. A server sends it only in its first answer.
struct NatNetVersion {
  int major = 3, minor = 0;
  bool at_least(int want_major, int want_minor) const {
    return major != want_major ? major > want_major : minor >= want_minor;
  }
};

struct NatNetBody {
  int id = 0;
  geometry::Pose world_from_body;  ///< metres; the world of Motive, y up unless set otherwise
  double mean_error_m = 0;
  bool tracked = false;
};

struct NatNetMarker {
  int body_id = 0;  ///< 0: belongs to no body
  int marker_id = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  bool occluded = false;  ///< not visible: the position is predicted from the body
  double residual_m = 0;
};

struct NatNetFrame {
  int number = 0;
  double time_s = 0;  ///< Motive's time since its start
  std::vector<NatNetBody> bodies;
  std::vector<NatNetMarker> markers;  ///< labelled markers, also those of no body
};

enum class NatNetKind : std::uint16_t { kServerInfo = 1, kModel = 5, kFrame = 7 };

/// One packet of a stream of packets: its kind and its payload.
struct NatNetPacket {
  std::uint16_t kind = 0;
  std::span<const std::byte> payload;
  std::size_t size = 0;  ///< bytes of the whole packet
};

/// Returns the first packet in `bytes` (a datagram, or a file of consecutive packets). Pure.
/// Errors: kFormat if the bytes end before the packet does.
Result<NatNetPacket> next_packet(std::span<const std::byte> bytes);

/// Reads the version from the payload of a kServerInfo packet. Errors: kFormat; kUnsupported below
/// 3.0.
Result<NatNetVersion> parse_server_info(std::span<const std::byte> payload);

/// Reads the frame from the payload of a kFrame packet. Pure. Counts that exceed the payload are
/// refused before anything is stored. Bodies whose rotation is no unit quaternion or that are not
/// finite are returned as not tracked. Errors: kFormat, naming the section.
Result<NatNetFrame> parse_frame(std::span<const std::byte> payload, NatNetVersion version);

/// Reads all frames of a file of packets, with the version of its server info, else `version`.
/// Other packets are skipped. Errors: those of next_packet(), parse_server_info() and
/// parse_frame(), with the packet's number.
Result<std::vector<NatNetFrame>> parse_capture(std::span<const std::byte> bytes,
                                               NatNetVersion version);

}  // namespace mixrig::stream
