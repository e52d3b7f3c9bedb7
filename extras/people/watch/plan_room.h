// SPDX-License-Identifier: Apache-2.0
// Points of a session's empty room, and what they hide from the camera.
#pragma once

#include <vector>

#include "extras/people/plan/floor_map.h"
#include "extras/people/plan/placing.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Points of the session's background, which must be ready. A background without a pose counts as
/// seen from `world_from_camera`.
std::vector<plan::RoomPoint> room_points(const Session& session,
                                         const geometry::Pose& world_from_camera);

/// Depth of the room in a small picture of the camera. Fills `depth_m`, which must outlive the
/// result.
plan::RoomView view_of_room(const std::vector<plan::RoomPoint>& points,
                            const geometry::Pinhole& view, const geometry::Pose& world_from_camera,
                            Image<float>& depth_m);

}  // namespace mixrig::session
