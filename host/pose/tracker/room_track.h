// SPDX-License-Identifier: Apache-2.0
// Tracks the camera of a take by its pictures and a scanned room.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/result.h"
#include "host/pose/tracker/take_pictures.h"
#include "host/pose/tracker/tracker.h"

namespace mixrig::session {

struct RoomTrackOptions {
  std::filesystem::path room, take;
  std::filesystem::path calibration;  ///< empty: the take's own
  TrackedCamera camera = TrackedCamera::kFisheye;
  /// Pose of the room in the world; absent: that of the room's folder; without that, poses are in
  /// axes of the room.
  std::optional<geometry::Pose> world_from_base;
  tracking::TrackerOptions tracker;
  /// Each pose is smoothed with poses up to this time before and after it; 0: not smoothed.
  double smooth_s = 0;
  bool anew = false;                       ///< the camera is searched for in every picture
  int passes = 1;                          ///< number of plays of the take, forwards and backwards
  std::filesystem::path drawings;          ///< folder for pictures with their patches; empty: none
  int threads = 0;                         ///< 0: one per core
  std::function<void(int, int)> progress;  ///< done and total; may be empty
};

struct TrackedPicture {
  double time_s = 0;  ///< mid-exposure, on the clock of Capture::time_s
  tracking::TrackedPose pose;
  geometry::Pose world_from_target;
  std::optional<geometry::Pose> truth;  ///< world_from_target
  double nees = 0;                      ///< e^T C^-1 e, if there are truth and a pose
  double seconds = 0;                   ///< time in the tracker
};

struct RoomTrack {
  std::vector<TrackedPicture> pictures;
  bool anew = false;                       ///< RoomTrackOptions::anew
  std::vector<TrackedPicture> unsmoothed;  ///< the poses before smoothing; empty if not smoothed
  double latency_s = 0;                    ///< time that smoothing waits for later pictures
  tracking::TrackerCounts counts;
  double seconds = 0;  ///< time in the tracker for all pictures
  bool world_known = false;
};

/// Tracks every picture of the take. Truth is truth/fisheye.tum, or true poses of the take; it is
/// compared with the poses only if the room's pose in the world is known.
/// Errors: those of room, take and calibration; kData if the calibration lacks the camera, or the
/// take has none of its pictures; kIo for drawings.
Result<RoomTrack> track_room(const RoomTrackOptions& options);

/// Reports the track: {"frames", "lost_pct", "fps", "frame_ms" (median over the pictures tracked
/// without a search), "search_ms" (over the others), "searches", "sigma_mm", "latency_s", and where
/// truth is known "rms_mm", "rms_deg", "p95_mm", "max_mm", "drift_mm_per_1000", "jitter_mm",
/// "jitter_deg", "nees"}: errors of the target camera; if smoothed, "unsmoothed" holds the values
/// before. The drift is the slope of the distance over the number of the picture; jitter the root
/// mean square of the errors' second differences from picture to picture; "nees" the mean of e^T
/// C^-1 e, 6 where the covariances are right. If the camera was searched for in every picture:
/// "starts": {"found", "wrong": of them more than 50 mm or 1 degree off, "refused", "p50_mm",
/// "search_ms": {"p50", "p95"}}.
nlohmann::json to_json(const RoomTrack& track);
/// Returns TUM lines "t x y z qx qy qz qw" of world_from_target at the pictures that have a pose.
std::string to_tum(const RoomTrack& track);

}  // namespace mixrig::session
