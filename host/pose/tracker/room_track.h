// SPDX-License-Identifier: Apache-2.0
// The path of a take's camera, from its pictures and a scanned room.
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
  std::filesystem::path calibration;  ///< empty: the take's
  TrackedCamera camera = TrackedCamera::kFisheye;
  /// Of the room; absent: as its folder says, or poses are in axes of the room.
  std::optional<geometry::Pose> world_from_base;
  tracking::TrackerOptions tracker;
  double smooth_s = 0;                     ///< poses so long before and after smooth each; 0: none
  bool anew = false;                       ///< every picture is looked for as the first one is
  int passes = 1;                          ///< the take is played so often, to and fro
  std::filesystem::path drawings;          ///< folder for pictures with their patches; empty: none
  int threads = 0;                         ///< 0: one per core
  std::function<void(int, int)> progress;  ///< done and total; may be empty
};

struct TrackedPicture {
  double time_s = 0;  ///< mid-exposure, on the clock of Capture::time_s
  tracking::TrackedPose pose;
  geometry::Pose world_from_target;
  std::optional<geometry::Pose> truth;  ///< world_from_target
  double nees = 0;                      ///< e^T C^-1 e, where there are truth and a pose
  double seconds = 0;                   ///< in the tracker
};

struct RoomTrack {
  std::vector<TrackedPicture> pictures;
  bool anew = false;                       ///< as asked for
  std::vector<TrackedPicture> unsmoothed;  ///< the same as they were tracked, where smoothed
  double latency_s = 0;                    ///< that smoothing waits for pictures to come
  tracking::TrackerCounts counts;
  double seconds = 0;  ///< in the tracker, of all pictures
  bool world_known = false;
};

/// Tracks every picture of the take. Truth is truth/fisheye.tum, or poses of the take that are
/// true; it is held against the poses only where the room's place in the world is known.
/// Errors: those of room, take and calibration; kData where the calibration lacks the camera, or
/// the take has none of its pictures; kIo for drawings.
Result<RoomTrack> track_room(const RoomTrackOptions& options);

/// {"frames", "lost_pct", "fps", "frame_ms" (median of the pictures that were not searched for),
/// "search_ms" (of the others), "searches", "sigma_mm", "latency_s", and where truth is known
/// "rms_mm", "rms_deg", "p95_mm", "max_mm", "drift_mm_per_1000", "jitter_mm", "jitter_deg",
/// "nees"}: errors of the target camera, and where smoothed, the same before under "unsmoothed".
/// The drift is the slope of the distance over the number of the picture; jitter the root mean
/// square of the errors' second differences from picture to picture; "nees" the mean of e^T C^-1 e,
/// 6 where the covariances are right. Where every picture was looked for anew: "starts": {"found",
/// "wrong": of them more than 50 mm or 1 degree off, "refused", "p50_mm", "search_ms": {"p50",
/// "p95"}}.
nlohmann::json to_json(const RoomTrack& track);
/// TUM lines "t x y z qx qy qz qw" of world_from_target at the pictures that have a pose.
std::string to_tum(const RoomTrack& track);

}  // namespace mixrig::session
