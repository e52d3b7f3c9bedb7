// SPDX-License-Identifier: Apache-2.0
// Reads OpenTrackIO 1.0 from other programs: datagrams, and samples as JSON or CBOR.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "extras/broadcast/packets/opentrackio.h"
#include "hal/base/result.h"
#include "host/math/geometry/pose.h"

namespace mixrig::stream {

inline constexpr std::size_t kOpenTrackMostBytes = 65536;  ///< largest sample that is read

/// Parses a datagram's header and payload; the payload is a part of `bytes`. Pure. Errors: kData
/// for another magic, encoding or length, or a wrong checksum.
Result<OpenTrackSegment> parse_opentrack_datagram(std::span<const std::byte> bytes);

/// Contents of a sample about a camera.
struct OpenTrackReading {
  int source = 0;                       ///< sourceNumber; 0: absent
  std::optional<std::int64_t> time_ns;  ///< sampleTimestamp, since 1970, UTC or TAI
  std::string status;                   ///< state of the tracker
  /// Product of the transforms, of a camera with axes x right, y down, z forward, on a stage with z
  /// up. Absent: unknown.
  std::optional<geometry::Pose> stage_from_camera;
};

/// Parses a sample's payload, nested at most 32 deep. Keys that are not used are not checked. Pure.
/// Errors: kData for bytes that are not JSON or CBOR of OpenTrackIO, values of another type, out of
/// bounds or not finite, and transforms that scale; kUnsupported for another major version.
Result<OpenTrackReading> parse_opentrack_payload(std::span<const std::byte> payload,
                                                 OpenTrackEncoding encoding);

}  // namespace mixrig::stream
