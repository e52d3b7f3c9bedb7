// SPDX-License-Identifier: Apache-2.0
// Computes the pose of a body in every frame of a motion-capture recording.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/math/geometry/pose.h"
#include "host/pose/mocap/constellation_file.h"
#include "host/pose/mocap/natnet.h"

namespace mixrig::mocap {

enum class Up { kY, kZ };  ///< which axis of the recording points up

/// Returns the rotation from such a world to one with z up.
geometry::Pose z_up_from(Up up);

struct TrackOptions {
  Up up = Up::kY;                   ///< the result has z up
  int body_id = 0;                  ///< 0: the only body; ignored for constellations
  geometry::Pose body_from_camera;  ///< from the external calibration
};

struct TrackedPose {
  double time_s = 0;
  geometry::Pose world_from_camera;
};

struct MocapTrack {
  std::vector<TrackedPose> poses;  ///< poses of the frames that have one, in order
  int frames = 0;
  std::map<std::string, int> refused;  ///< number of frames by reason
  double residual_rms_m = 0;           ///< markers to the body's shape; 0 for track_bodies()
};

/// Computes poses from markers alone: labels are found by shape (match_constellation), the
/// recording's labels are ignored; occluded markers are left out.
MocapTrack track_markers(const std::vector<stream::NatNetFrame>& frames,
                         const Constellation& constellation, const TrackOptions& options);

/// Takes the poses of the recording's bodies. Errors: kData if `body_id` is 0 and there are several
/// bodies, or if no body has that id.
Result<MocapTrack> track_bodies(const std::vector<stream::NatNetFrame>& frames,
                                const TrackOptions& options);

/// Returns the poses as TUM lines: t x y z qx qy qz qw.
std::string to_tum(const MocapTrack& track);

}  // namespace mixrig::mocap
