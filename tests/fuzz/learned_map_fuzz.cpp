// SPDX-License-Identifier: Apache-2.0
// Any bytes as manifests and points of learned maps.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "extras/map/reconstruction/maps/map_file.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(learned_map) {
  using namespace mixrig;
  (void)reconstruction::parse_map_manifest({reinterpret_cast<const char*>(data), size}, "m");
  constexpr int kKeys = 3;
  const auto read =
      reconstruction::parse_map_points(std::as_bytes(std::span(data, size)), kKeys, "p");
  if (!read) return 0;
  for (const auto& point : read->points)
    if (point.key < 0 || point.key >= kKeys || !point.place.allFinite()) std::abort();
  for (const auto& d : read->descriptors)
    if (d.point < 0 || d.point >= static_cast<int>(read->points.size())) std::abort();
  return 0;
}
