// SPDX-License-Identifier: Apache-2.0
// The virtual object: a statue on a crate.
#pragma once

#include "studio/stage/mesh.h"
#include "studio/studio.h"

namespace mixrig::studio {

/// Crate and statue, about 1.3 m high, in object axes with the origin on the floor. `glossy`: both
/// mirror light, as dielectrics.
VirtualObject build_object(const geometry::Pose& world_from_object, bool glossy = false);
/// The object's triangles in world axes for the tracer; Material::variant is the mesh.
Mesh object_in_world(const VirtualObject& object);

}  // namespace mixrig::studio
