// SPDX-License-Identifier: Apache-2.0
// Poses of the target camera from the fisheye's pictures and a scanned room.
#pragma once

#include <memory>

#include "host/capture/capture/pose_source.h"
#include "host/math/geometry/any_camera.h"
#include "host/pose/source/picture_motion.h"
#include "host/pose/tracker/tracker.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::pose {

struct TrackerPoseOptions {
  geometry::AnyCamera fisheye;
  geometry::Pose fisheye_from_target;
  geometry::Pose world_from_base;  ///< pose of the room
  Predict predict = Predict::kVelocity;
  /// Latency, 0 to 0.5: poses are smoothed over the pictures up to this time before and after;
  /// `predict` then decides whether the head's angles are used.
  double smooth_s = 0;
  std::optional<calibration_file::PanTilt> head;  ///< carries the target camera; for `predict`
  tracking::TrackerOptions tracker;
  int threads = 0;  ///< 0: one per core
};

/// Tracks each fresh picture of the fisheye when its capture is asked for. The plate has another
/// time: between the newest two pictures the motion is interpolated, after the newest one it is
/// continued (Predict), so that no frame waits; or, with a latency, each pose is smoothed. The
/// covariance is enlarged for a camera that changes its speed by 1 m/s^2 and 2 rad/s^2. A capture
/// with a picture takes some milliseconds longer; one whose camera must be searched for takes up to
/// a second, and only that allocates. Pictures of another size than the calibrated one are left
/// out. A capture whose fisheye is missing has no pose.
std::unique_ptr<capture::PoseSource> make_tracker_poses(const model::Panorama& room,
                                                        const TrackerPoseOptions& options);

}  // namespace mixrig::pose
