// SPDX-License-Identifier: Apache-2.0
// Size and place of a model that comes into a scene.
#pragma once

#include <Eigen/Core>

#include "host/operator/desk/room_sight.h"
#include "host/scene/scene.h"

namespace mixrig::session {

/// Longest side of a model's bounding box. Precondition: the model has a vertex.
double largest_m(const scene::Model& model);

/// Sets scale and pose: its lowest vertex is on the level of `place`, its middle above that point.
/// A model larger than four fifths of what the picture shows at that distance, or smaller than
/// 5 cm, is made in other units than metres: it gets the scale at which it fills half of the
/// picture, or a tenth. World axes. Pure.
void fit(scene::Object& object, const SeenFrom& from, const Eigen::Vector3d& place);

}  // namespace mixrig::session
