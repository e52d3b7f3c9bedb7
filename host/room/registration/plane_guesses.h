// SPDX-License-Identifier: Apache-2.0
// Poses of one room in another's axes that their planes allow. Private to this module.
#pragma once

#include <vector>

#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// a_from_b of each way to put three planes of b that are not parallel onto three of a. Some are
/// nearly the same. Empty where a room has no three such planes.
std::vector<geometry::Pose> poses_from_planes(const std::vector<RoomPlane>& a,
                                              const std::vector<RoomPlane>& b);

/// a_from_b of each way to put the floor and a wall of b onto those of a, at steps of `step_m` up
/// to 12 m either way along the wall: a hall's end may be seen by one room alone.
std::vector<geometry::Pose> poses_along_walls(const std::vector<RoomPlane>& a,
                                              const std::vector<RoomPlane>& b, double step_m);

}  // namespace mixrig::model
