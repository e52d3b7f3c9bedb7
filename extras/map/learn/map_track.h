// SPDX-License-Identifier: Apache-2.0
// Finds the path of a take's camera in a learned map; joins maps, and places maps in rooms.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "hal/base/result.h"
#include "host/pose/tracker/take_pictures.h"
#include "host/pose/tracker/tracker.h"

namespace mixrig::session {

struct MapTrackOptions {
  std::filesystem::path map, take;
  std::filesystem::path calibration;  ///< empty: the take's
  /// Pose of the room whose axes the map has. Absent: as in the map; if absent there, poses are in
  /// axes of the room.
  std::optional<geometry::Pose> world_from_room;
  tracking::TrackerOptions tracker;
  int threads = 0;  ///< 0: one per core
};

struct MapTrack {
  /// Keys of to_json(RoomTrack). Where the take has truth, also the keys of errors_of_path() for
  /// the map's camera; for a map in axes of a room whose pose is known, the errors of
  /// to_json(RoomTrack).
  nlohmann::json report;
  /// Poses of the pictures that have one: map_from_camera; for a map in axes of a room
  /// world_from_target.
  std::string tum;
  bool lost = false;  ///< no picture has a pose
};

/// Tracks every picture of the take by the camera that learned the map, without learning. Errors:
/// those of map, take and calibration; kData where the take has no picture of that camera.
Result<MapTrack> track_map(const MapTrackOptions& options);

struct MapRoomOptions {
  std::filesystem::path map, room, out;
  std::filesystem::path calibration;  ///< calibration of the camera that learned the map
  tracking::TrackerOptions tracker;   ///< settings for finding the key pictures in the room
  int threads = 0;                    ///< 0: one per core
};

/// Writes the map in axes of the scanned room (of the first one of joined rooms), in metres.
/// Returns {"keys", "keys_found", "keys_agree", "points", "points_agree", "metres_per_unit",
/// "scale_sigma_pct", "sigma_mm", "sigma_deg", "room_from_map"}. Errors: those of map, room and
/// calibration, of reconstruction::place_in_room(), and of writing.
Result<nlohmann::json> place_map(const MapRoomOptions& options);

/// Writes the map `second` in axes, units and times of `first`. Returns {"time_offset_s",
/// "time_offset_sigma_s", "rotation_xyzw" (second camera to first), "rotation_sigma_deg", "scale",
/// "scale_sigma_pct", "spread", "first_from_second"}. Errors: those of reconstruction::join(),
/// reading and writing.
Result<nlohmann::json> join_maps(const std::filesystem::path& first,
                                 const std::filesystem::path& second,
                                 const std::filesystem::path& out);

}  // namespace mixrig::session
