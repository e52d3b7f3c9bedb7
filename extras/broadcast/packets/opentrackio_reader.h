// SPDX-License-Identifier: Apache-2.0
// OpenTrackIO 1.0 as other programs send it: datagrams, and samples as JSON or CBOR.
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

inline constexpr std::size_t kOpenTrackMostBytes = 65536;  ///< of a sample that is read

/// The header and payload of a datagram; the payload is a part of `bytes`. Pure. Errors: kData for
/// another magic, encoding or length, or a wrong checksum.
Result<OpenTrackSegment> parse_opentrack_datagram(std::span<const std::byte> bytes);

/// What a sample tells of a camera.
struct OpenTrackReading {
  int source = 0;                       ///< sourceNumber; 0: not told
  std::optional<std::int64_t> time_ns;  ///< sampleTimestamp, since 1970
  std::string status;                   ///< of the tracker
  /// The product of the transforms, of a camera with axes x right, y down, z forward. The stage has
  /// z up. None: not known.
  std::optional<geometry::Pose> stage_from_camera;
};

/// Pure; nested at most 32 deep. Keys that are not read are not checked. Errors: kData for bytes
/// that are no JSON or CBOR of OpenTrackIO, values of another type, out of bounds or not finite,
/// and transforms that scale; kUnsupported for another major version.
Result<OpenTrackReading> parse_opentrack_payload(std::span<const std::byte> payload,
                                                 OpenTrackEncoding encoding);

}  // namespace mixrig::stream
