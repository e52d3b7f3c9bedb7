// SPDX-License-Identifier: Apache-2.0
// Errors of a path against the truth after alignment.
#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>

#include "host/math/geometry/pose.h"

namespace mixrig::session {

/// A pose of the camera in axes of a map, and in the world.
struct PosePair {
  geometry::Pose found, truth;
};

/// Aligns the positions of `found` with those of `truth` by a rigid motion, or by a similarity
/// where `free_scale`. Returns {"aligned": "rigid" or "similarity", "extent_m" of the true path,
/// "rms_mm", "p95_mm", "max_mm", "rms_deg", "rms_pct" of the extent, "drift_mm_per_1000",
/// "metres_per_unit" of the map}; null for fewer than 3 pairs, or where they do not determine the
/// motion.
nlohmann::json errors_of_path(std::span<const PosePair> pairs, bool free_scale);

}  // namespace mixrig::session
