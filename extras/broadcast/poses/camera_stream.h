// SPDX-License-Identifier: Apache-2.0
// Poses of the target camera from a camera tracker that sends FreeD or OpenTrackIO.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/capture/capture/pose_source.h"
#include "host/pose/source/pose_track.h"
#include "host/scene/scene.h"

namespace mixrig::pose {

/// Noise of the tracked camera's pose as the tracker's maker states it: standard deviations about
/// and along each axis.
struct TrackerNoise {
  double turn_rad = 0, shift_m = 0;
};

struct CameraStreamOptions {
  std::string address;                ///< "[HOST:]PORT[,NUMBER]"
  geometry::Pose world_from_tracker;  ///< both with z up
  Mount mount;                        ///< target camera's pose on the tracked camera
  std::optional<TrackerNoise> noise;  ///< absent: the poses have no covariance
  double delay_s = 0;                 ///< delay from a sample's exposure to its earliest arrival
  double most_ahead_s = 0.1;          ///< the motion is continued this far after the newest sample
  double rate_hz = 0;  ///< FreeD: rate of the sender; 0: arrival times are used unchanged
  /// OpenTrackIO: clock of the stamps.
  scene::TrackerStream::Stamps stamps = scene::TrackerStream::Stamps::kArrival;
};

/// Pose of the target camera, from the tracked camera's pose in the tracker's world. Pure.
TargetSeen target_seen(const geometry::Pose& tracker_from_camera,
                       const CameraStreamOptions& options);

/// Opens a source of poses by FreeD. It listens in its own thread until it is destroyed, which
/// takes up to 0.1 s. Poses are at Capture::mid_exposure, which must be on the clock of `clock`;
/// that outlives the source. A packet's time is its arrival without jitter (ArrivalComb), less
/// delay_s; a packet whose values are at the end of their range has no pose. A socket that fails is
/// logged once; from then on every pose is too old. Errors: kUsage for the address, kDevice for the
/// port.
Result<std::unique_ptr<capture::PoseSource>> open_freed_poses(CameraStreamOptions options,
                                                              const Clock& clock);

/// Opens a source of poses by OpenTrackIO, like open_freed_poses(). Times are the samples' stamps;
/// their clock is mapped to the host's by the least delay, or is the system clock (StampScale). A
/// sample without stamp or transforms has no pose.
Result<std::unique_ptr<capture::PoseSource>> open_opentrack_poses(CameraStreamOptions options,
                                                                  const Clock& clock);

}  // namespace mixrig::pose
