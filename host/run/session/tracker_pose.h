// SPDX-License-Identifier: Apache-2.0
// The pose source of pose = "tracker".
#pragma once

#include <memory>

#include "host/capture/capture/pose_source.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Tracks in the room that is the scene's background, by the calibration in use. Errors: kFormat
/// where the scene has no such room, the room no place, or the calibration no file; kData where the
/// source has no fisheye, or pictures of another size; those of the files.
Result<std::unique_ptr<capture::PoseSource>> tracker_poses(const Session& session);

}  // namespace mixrig::session
