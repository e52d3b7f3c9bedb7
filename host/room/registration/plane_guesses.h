// SPDX-License-Identifier: Apache-2.0
// Poses of one room in another's axes that match their planes. Private to this module.
#pragma once

#include <vector>

#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Poses a_from_b for each way to match three non-parallel planes of b with three of a. Some are
/// nearly equal. Empty if a room has no three such planes.
std::vector<geometry::Pose> poses_from_planes(const std::vector<RoomPlane>& a,
                                              const std::vector<RoomPlane>& b);

/// Poses a_from_b for each way to match the floor and a wall of b with those of a, at steps of
/// `step_m` up to 12 m either way along the wall: the end of a hall may be seen by one room only.
std::vector<geometry::Pose> poses_along_walls(const std::vector<RoomPlane>& a,
                                              const std::vector<RoomPlane>& b, double step_m);

}  // namespace mixrig::model
