// SPDX-License-Identifier: Apache-2.0
// Any bytes as views.toml and as angles of a pan-tilt unit: whole and in range, or refused.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "host/calibrate/rig/view_set.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(view_set) {
  using namespace mixrig;
  if (size == 0) return 0;
  const int views = data[0] % 8 + 1;
  const std::string text(reinterpret_cast<const char*>(data + 1), size - 1);
  std::string file;
  if (const auto set = calibration::parse_view_set(text, "views.toml", file);
      set && (set->views < 1 || set->cameras.empty() || set->columns < 1 || set->rows < 1))
    std::abort();
  const auto angles = calibration::parse_angles(text, "ptu.csv", views);
  if (!angles) return 0;
  if (static_cast<int>(angles->size()) != views) std::abort();
  for (const auto& a : *angles)
    if (!std::isfinite(a.pan_rad) || !std::isfinite(a.tilt_rad)) std::abort();
  return 0;
}
