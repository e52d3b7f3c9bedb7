// SPDX-License-Identifier: Apache-2.0
// What was moved between two scans. Private to this module.
#pragma once

#include <vector>

#include "host/room/registration/room_registration.h"
#include "host/room/registration/sides.h"

namespace mixrig::model {

/// Where places of either room lie in what the other sees as free space, more than 50 mm off; the
/// largest first, at least 9 square degrees.
std::vector<MovedArea> moved_areas(const Sides& sides, const geometry::Pose& a_from_b);

}  // namespace mixrig::model
