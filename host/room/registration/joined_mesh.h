// SPDX-License-Identifier: Apache-2.0
// Triangles of joined rooms: each surface from the room that saw it best.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"
#include "host/room/scan/shape/room_mesh.h"

namespace mixrig::model {

struct JoinedPart {
  const Panorama* panorama;
  geometry::Pose first_from_base;
};

/// grid_mesh() of each part without triangles that another part sees better: both agree there to 20
/// mm or three sigma, and the other's sigma over the cosine of incidence is less (the earlier part
/// wins ties). In the axes of its own room; not simplified.
std::vector<RoomMesh> joined_grids(const std::vector<JoinedPart>& parts, Crew& crew);

/// Transforms positions and normals into the axes of the first room.
void place(const geometry::Pose& first_from_base, RoomMesh& mesh);

}  // namespace mixrig::model
