// SPDX-License-Identifier: Apache-2.0
// World frames for takes without poses.
#pragma once

#include "host/math/geometry/plane.h"
#include "host/math/geometry/pose.h"

namespace mixrig::session {

/// Returns world_from_camera for `pose = "floor"`: origin on the floor below the camera, z up, y
/// along the floor in viewing direction (for a camera that looks straight up or down: the direction
/// of its image's top), x right. `floor` is in camera axes, its normal towards the camera.
geometry::Pose world_from_camera_on_floor(const geometry::Plane& floor);

}  // namespace mixrig::session
