// SPDX-License-Identifier: Apache-2.0
// Finds where virtual objects touch the ground.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/render/contract/compositor.h"

namespace mixrig::session {

/// Points of each object's footprint, world axes, metres: among its vertices within 1 % of its
/// height above the lowest one, those with the least and the greatest x and y. At most four an
/// object, each once; none for an object without vertices.
std::vector<Eigen::Vector3d> contact_points(const std::vector<render::VirtualObject>& objects);

}  // namespace mixrig::session
