// SPDX-License-Identifier: Apache-2.0
// Makes the pose source that a scene asks for.
#pragma once

#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/pose/source/frame_poses.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Checks what can be known before the first frame: the chain is calibrated, the trajectory is
/// readable and overlaps the take in time, the source has angles or poses. Makes session.poses,
/// except for pose = "floor" and network poses, which prepare_poses() makes. Errors: kFormat,
/// kData, kUsage, with the scene's file and key; those of the files.
Result<void> check_poses(Session& session);

/// Makes session.poses if missing. Call it after prepare_background() for pose = "floor", which
/// needs the floor, and before it otherwise, since a moving camera's background is learned by its
/// poses. `clock` must outlive the session. Errors: those of check_poses() and of the network.
Result<void> prepare_poses(Session& session, const Clock& clock);

/// Options for old and lost poses by the scene.
pose::FramePoseOptions frame_pose_options(const scene::Scene& scene);

/// Checks that the pan-tilt unit stays still while the scene's pose is constant: else the picture
/// would be wrong.
class HeadWatch {
 public:
  /// Error line that refuses or stops the run, once the head of a camera with a constant pose has
  /// turned by more than kStill_rad since the first capture. Allocates only then.
  std::optional<std::string> fault(const Session& session, const capture::Capture& capture);
  static constexpr double kStill_rad = 0.002;

 private:
  std::optional<device::PanTiltAngles> first_;
};

}  // namespace mixrig::session
