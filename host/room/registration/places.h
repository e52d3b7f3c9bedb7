// SPDX-License-Identifier: Apache-2.0
// Places on the surfaces of a room, and what another room's panorama says of them. Private to this
// module.
#pragma once

#include <vector>

#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// A small piece of surface, in base axes of its room.
struct RoomPlace {
  Eigen::Vector3d at_m, normal;  ///< the normal points away from the origin
  double sigma_m = 0;
  Eigen::Vector3f color;  ///< sRGB, 0..255
};

/// Places evenly over the directions where views measured, about `step_rad` apart.
std::vector<RoomPlace> places_of(const Panorama& panorama, double step_rad);

enum class RoomSight : std::uint8_t {
  kNone,     ///< unknown there, seen from behind or at a grazing angle
  kHidden,   ///< behind a surface of the other room
  kAgrees,   ///< on the surface that the other room has there
  kAgainst,  ///< in what the other room sees as free space
};

struct Seen {
  RoomSight sight = RoomSight::kNone;
  double off_m = 0;                ///< along the normal; positive behind the other room's surface
  double incidence = 0;            ///< cosine between ray and normal, from the other origin
  double sigma_m = 0;              ///< of the other room's distance
  Eigen::Vector3f color{0, 0, 0};  ///< of the other room
};

/// What a panorama says of a place given in its own axes. Further off than `gate_m` and three
/// sigma is not the same surface.
Seen look(const Panorama& panorama, const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal,
          double sigma_m, double gate_m);

}  // namespace mixrig::model
