// SPDX-License-Identifier: Apache-2.0
// Poses of one room in another's axes that their planes allow. Private to this room.
#pragma once

#include <vector>

#include "host/geometry/pose.h"
#include "host/model/panorama.h"

namespace mixrig::model {

/// a_from_b of each way to put three planes of b that are not parallel onto three of a. Some are
/// nearly the same. Empty where a room has no three such planes.
std::vector<geometry::Pose> poses_from_planes(const std::vector<RoomPlane>& a,
                                              const std::vector<RoomPlane>& b);

}  // namespace mixrig::model
