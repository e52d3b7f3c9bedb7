// SPDX-License-Identifier: Apache-2.0
// Pose sources "freed:..." and "opentrackio:..." of a scene.
#pragma once

#include <array>

#include "host/run/session/extra_poses.h"

namespace mixrig::broadcast {

/// Pose sources for SessionOptions::extra_poses. Errors: kUsage for the address; kDevice for the
/// port; those of the calibration.
std::array<session::ExtraPoses, 2> scene_poses();

}  // namespace mixrig::broadcast
