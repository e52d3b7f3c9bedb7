// SPDX-License-Identifier: Apache-2.0
// Makes the pose source for pose = "tracker".
#pragma once

#include <memory>

#include "host/capture/capture/pose_source.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Makes a tracker in the room that is the scene's background, with the calibration in use. Errors:
/// kFormat if the scene has no such room, the room no place, or the calibration no file; kData if
/// the source has no fisheye, or pictures of another size; those of the files.
Result<std::unique_ptr<capture::PoseSource>> tracker_poses(const Session& session);

}  // namespace mixrig::session
