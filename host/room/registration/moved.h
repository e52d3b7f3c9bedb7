// SPDX-License-Identifier: Apache-2.0
// Finds what was moved between two scans. Private to this module.
#pragma once

#include <vector>

#include "host/room/registration/room_registration.h"
#include "host/room/registration/sides.h"

namespace mixrig::model {

/// Areas of either room that lie more than 50 mm inside what the other room sees as free space; at
/// least 9 square degrees, the largest first.
std::vector<MovedArea> moved_areas(const Sides& sides, const geometry::Pose& a_from_b);

}  // namespace mixrig::model
