// SPDX-License-Identifier: Apache-2.0
// Any bytes as OpenTrackIO: as a datagram, as segments of samples, as JSON and as CBOR.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "extras/broadcast/packets/opentrackio_assembler.h"
#include "tests/fuzz/target.h"

namespace {

void check_payload(std::span<const std::byte> bytes, mixrig::stream::OpenTrackEncoding encoding) {
  const auto reading = mixrig::stream::parse_opentrack_payload(bytes, encoding);
  if (!reading || !reading->stage_from_camera) return;
  const auto& pose = *reading->stage_from_camera;
  if (!pose.translation_m.allFinite() || std::abs(pose.rotation.norm() - 1) > 1e-6) std::abort();
}

/// Assembles short pieces of the bytes under headers that the first bytes select.
void check_segments(std::span<const std::byte> bytes) {
  using namespace mixrig::stream;
  OpenTrackAssembler assembler;
  while (bytes.size() > 4) {
    const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
    const std::size_t size = std::min<std::size_t>(at(3), bytes.size() - 4);
    const OpenTrackSegment segment{at(0) & 1U ? OpenTrackEncoding::kCbor : OpenTrackEncoding::kJson,
                                   static_cast<std::uint16_t>(at(1) % 4 * 16383), at(2) % 16 * 64,
                                   (at(0) & 2U) != 0, bytes.subspan(4, size)};
    const Sender from{0, static_cast<std::uint16_t>(at(0) >> 6)};
    if (const auto whole = assembler.add(segment, from))
      check_payload(whole->bytes, whole->encoding);
    bytes = bytes.subspan(4 + size);
  }
}

}  // namespace

MIXRIG_FUZZ_TARGET(opentrackio) {
  using namespace mixrig::stream;
  const auto bytes = std::as_bytes(std::span(data, size));
  check_payload(bytes, OpenTrackEncoding::kJson);
  check_payload(bytes, OpenTrackEncoding::kCbor);
  check_segments(bytes);
  const auto segment = parse_opentrack_datagram(bytes);
  if (!segment) return 0;
  check_payload(segment->payload, segment->encoding);
  // An accepted segment is written as the same bytes, except the reserved byte and the checksum.
  auto again = opentrack_datagram(*segment);
  again[4] = bytes[4];
  for (std::size_t i = 0; i < again.size(); ++i)
    if (i != 14 && i != 15 && again[i] != bytes[i]) std::abort();
  return 0;
}
