// SPDX-License-Identifier: Apache-2.0
// Any bytes as constellation files, external calibration files and motion-capture CSV.
#include <string_view>

#include "host/pose/mocap/external.h"
#include "host/pose/mocap/marker_file.h"
#include "host/pose/mocap/track.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(mocap) {
  using namespace mixrig;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  (void)mocap::parse_constellation(text, "c");
  if (const auto input = mocap::parse_external(text, "e")) (void)mocap::calibrate_external(*input);
  if (const auto frames = mocap::parse_mocap_csv(text, "m"))
    if (const auto track = mocap::track_bodies(*frames, {})) (void)mocap::to_tum(*track);
  return 0;
}
