// SPDX-License-Identifier: Apache-2.0
// The pose of a body in every frame of a motion-capture recording.
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

/// Rotation from such a world to one with z up.
geometry::Pose z_up_from(Up up);

struct TrackOptions {
  Up up = Up::kY;                   ///< the result has z up
  int body_id = 0;                  ///< 0: the only body; ignored for constellations
  geometry::Pose body_from_camera;  ///< of the external calibration
};

struct TrackedPose {
  double time_s = 0;
  geometry::Pose world_from_camera;
};

struct MocapTrack {
  std::vector<TrackedPose> poses;  ///< of the frames with an answer, in order
  int frames = 0;
  std::map<std::string, int> refused;  ///< reason: frames
  double residual_rms_m = 0;  ///< of markers to the body's shape; 0 where bodies were given
};

/// Poses from markers alone: labels are found by shape (match_constellation), the recording's
/// labels are ignored; occluded markers are left out.
MocapTrack track_markers(const std::vector<stream::NatNetFrame>& frames,
                         const Constellation& constellation, const TrackOptions& options);

/// Poses as the recording has them. Errors: kData where `body_id` is 0 and there are several
/// bodies, or there is none of that number.
Result<MocapTrack> track_bodies(const std::vector<stream::NatNetFrame>& frames,
                                const TrackOptions& options);

/// TUM lines: t x y z qx qy qz qw.
std::string to_tum(const MocapTrack& track);

}  // namespace mixrig::mocap
