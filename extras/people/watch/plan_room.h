// SPDX-License-Identifier: Apache-2.0
// The empty room of a session as a plan needs it: points, and what hides what from the camera.
#pragma once

#include <vector>

#include "extras/people/plan/floor_map.h"
#include "extras/people/plan/placing.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Of the session's background, which is ready; of one without a place, seen from
/// `world_from_camera`.
std::vector<plan::RoomPoint> room_points(const Session& session,
                                         const geometry::Pose& world_from_camera);

/// The room's depth in a small picture of the camera; borrows `depth_m`, which it fills.
plan::RoomView view_of_room(const std::vector<plan::RoomPoint>& points,
                            const geometry::Pinhole& view, const geometry::Pose& world_from_camera,
                            Image<float>& depth_m);

}  // namespace mixrig::session
