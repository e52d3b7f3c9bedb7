// SPDX-License-Identifier: Apache-2.0
// The pose source that a scene asks for.
#pragma once

#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/pose/source/frame_poses.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// What can be known before the first frame is composited: that the chain is calibrated, the
/// trajectory is readable and overlaps the take in time, the source has angles or poses. Makes
/// session.poses except for pose = "floor" and those of a network, which prepare_poses() makes.
/// Errors: kFormat, kData, kUsage, with the scene's file and key; those of the files.
Result<void> check_poses(Session& session);

/// Makes session.poses where it is not made yet. For pose = "floor" after prepare_background(),
/// which finds the floor; for all others before it, since it learns by the poses of a camera that
/// moves. `clock` must outlive the session. Errors: as check_poses(); those of the network.
Result<void> prepare_poses(Session& session, const Clock& clock);

/// Ages and lost poses as the scene wants them.
pose::FramePoseOptions frame_pose_options(const scene::Scene& scene);

/// Watches a head that turns while the scene's pose stays: the picture would be wrong.
class HeadWatch {
 public:
  /// The line to refuse or stop the run with, once the head of a camera with a constant pose has
  /// turned by more than kStill_rad since the first capture. Allocates only then.
  std::optional<std::string> fault(const Session& session, const capture::Capture& capture);
  static constexpr double kStill_rad = 0.002;

 private:
  std::optional<device::PanTiltAngles> first_;
};

}  // namespace mixrig::session
