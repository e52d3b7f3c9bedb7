// SPDX-License-Identifier: Apache-2.0
// Where virtual objects touch the ground.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/render/contract/compositor.h"

namespace mixrig::session {

/// Points of the footprint of each object, world axes, metres: of its vertices that lie within 1 %
/// of its height above its lowest one, those with the least and the greatest x and y. At most four
/// an object, each once; none of an object without vertices.
std::vector<Eigen::Vector3d> contact_points(const std::vector<render::VirtualObject>& objects);

}  // namespace mixrig::session
