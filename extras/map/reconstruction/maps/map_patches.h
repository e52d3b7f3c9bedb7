// SPDX-License-Identifier: Apache-2.0
// Converts a learned map to patches that the tracker aligns.
#pragma once

#include "extras/map/reconstruction/maps/learned_map.h"
#include "host/math/geometry/any_camera.h"
#include "host/pose/tracker/patch_map.h"

namespace mixrig::reconstruction {

/// Makes one patch for each point and each of `levels` resolutions, the finest that of the point's
/// key picture. Its pixels lie on a plane through the point: the plane of the points around it
/// where they agree on one, else a plane across the view. `camera` took the key pictures. Points
/// without contrast around them have no patch; occlusion is ignored.
tracking::PatchMap patches_of(const LearnedMap& map, const geometry::AnyCamera& camera,
                              int levels = 5);

}  // namespace mixrig::reconstruction
