// SPDX-License-Identifier: Apache-2.0
// Any bytes as NatNet packets, in both layouts.
#include <cmath>
#include <cstdlib>

#include "host/pose/mocap/natnet.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(natnet) {
  using namespace mixrig::stream;
  const auto bytes = std::as_bytes(std::span(data, size));
  for (const NatNetVersion version : {NatNetVersion{3, 0}, NatNetVersion{4, 1}}) {
    (void)parse_capture(bytes, version);
    const auto frame = parse_frame(bytes, version);
    if (!frame) continue;
    for (const NatNetBody& body : frame->bodies)
      if (body.tracked && !(std::abs(body.world_from_body.rotation.norm() - 1) < 1e-9))
        std::abort();
    for (const NatNetMarker& marker : frame->markers)
      if (!marker.position_m.allFinite()) std::abort();
  }
  return 0;
}
