// SPDX-License-Identifier: Apache-2.0
// The path of a take's camera in a learned map; two maps joined.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "hal/base/result.h"
#include "host/session/take_pictures.h"
#include "host/tracking/tracker.h"

namespace mixrig::session {

struct MapTrackOptions {
  std::filesystem::path map, take;
  std::filesystem::path calibration;  ///< empty: the take's
  tracking::TrackerOptions tracker;
  int threads = 0;  ///< 0: one per core
};

struct MapTrack {
  /// Keys of to_json(RoomTrack) without truth, and where the take has it those of
  /// errors_of_path(): of the map's camera.
  nlohmann::json report;
  std::string tum;    ///< map_from_camera at the pictures that have a pose
  bool lost = false;  ///< at all pictures
};

/// Tracks every picture of the take by the camera that learned the map; nothing new is learned.
/// Errors: those of map, take and calibration; kData where the take has none of its pictures.
Result<MapTrack> track_map(const MapTrackOptions& options);

/// Writes the map `second` in axes, units and times of `first`. Returns {"time_offset_s",
/// "time_offset_sigma_s", "rotation_sigma_deg", "scale", "scale_sigma_pct", "spread",
/// "first_from_second"}. Errors: those of reconstruction::join(), reading and writing.
Result<nlohmann::json> join_maps(const std::filesystem::path& first,
                                 const std::filesystem::path& second,
                                 const std::filesystem::path& out);

}  // namespace mixrig::session
