// SPDX-License-Identifier: Apache-2.0
// Any bytes as the head of a Matroska file, and as FFV1 records and frames.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "host/capture/take/streams/ffv1_format.h"
#include "host/capture/take/streams/matroska_tracks.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(matroska_tracks) {
  using namespace mixrig;
  const std::span<const std::uint8_t> bytes(data, size);
  if (const auto tracks = take::parse_tracks(bytes); tracks && tracks->size() > take::kMostTracks)
    std::abort();
  for (const auto& format : {take::ffv1_format(bytes, {}), take::ffv1_format({}, bytes)})
    if (format && take::text_of(*format).empty()) std::abort();
  return 0;
}
