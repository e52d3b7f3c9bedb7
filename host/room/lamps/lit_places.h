// SPDX-License-Identifier: Apache-2.0
// Places of a scanned room that show how its lamps light it.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/room/lamps/lamp_tracks.h"
#include "host/room/lamps/room_surfaces.h"

namespace mixrig::lights {

/// Parts of the sphere: 8 azimuths, 4 elevations.
inline constexpr int kLitParts = 32;

/// A place on a large plane.
struct LitPlace {
  int plane = 0;
  int part = 0;             ///< of the sphere around the scan, below kLitParts
  Vector3d linear;          ///< measured light
  Eigen::RowVectorXd gain;  ///< of each lamp's intensity, then 1 for the ambient light
};

/// Places evenly over the sphere around the scan, of which those on planes of the room with a grey
/// level that can be measured are kept. `most`: about so many.
std::vector<LitPlace> lit_places(const RoomSurfaces& room, std::span<const FoundLamp> lamps,
                                 int most);

/// Leaves out planes with few places, and numbers the others anew. Returns their count.
int keep_large_planes(std::vector<LitPlace>& places);

}  // namespace mixrig::lights
