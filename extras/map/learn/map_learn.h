// SPDX-License-Identifier: Apache-2.0
// Learns a map from a take's pictures.
#pragma once

#include <filesystem>
#include <functional>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/result.h"
#include "host/pose/tracker/take_pictures.h"

namespace mixrig::session {

struct MapLearnOptions {
  std::filesystem::path take, out;
  std::filesystem::path calibration;  ///< empty: the take's
  TrackedCamera camera = TrackedCamera::kFisheye;
  int tracks = 1500;                       ///< points that are tracked at a time
  int threads = 0;                         ///< 0: one per core
  std::function<void(int, int)> progress;  ///< done and total; may be empty
};

/// Learns and writes the map. Returns {"pictures", "poses", "keys", "points", "descriptors",
/// "scale" ("metric" or "unknown"), "scale_sigma_pct", "scale_measurements", "residual_px",
/// "seconds"}; where the take has truth, also the keys of errors_of_path(), and for a metric map
/// "scale_error_pct", "rms_similarity_mm" and "rms_similarity_pct", after a similarity. Errors:
/// those of take and calibration, of reconstruction::reconstruct() and of writing.
Result<nlohmann::json> learn_map(const MapLearnOptions& options);

}  // namespace mixrig::session
