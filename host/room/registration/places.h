// SPDX-License-Identifier: Apache-2.0
// Places on a room's surfaces, and how they appear in another room's panorama. Private to this
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

/// Places spread evenly over the directions that views measured, about `step_rad` apart.
std::vector<RoomPlace> places_of(const Panorama& panorama, double step_rad);

enum class RoomSight : std::uint8_t {
  kNone,     ///< unknown there, seen from behind, or at a grazing angle
  kHidden,   ///< behind a surface of the other room
  kAgrees,   ///< on the other room's surface
  kAgainst,  ///< in what the other room sees as free space
};

struct Seen {
  RoomSight sight = RoomSight::kNone;
  double off_m = 0;                ///< along the normal; positive behind the other room's surface
  double incidence = 0;            ///< cosine between ray and normal, from the other origin
  double sigma_m = 0;              ///< of the other room's distance
  Eigen::Vector3f color{0, 0, 0};  ///< of the other room
};

/// Compares a place, given in the panorama's axes, with the panorama. Beyond `gate_m` and three
/// sigma it is not the same surface.
Seen look(const Panorama& panorama, const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal,
          double sigma_m, double gate_m);

}  // namespace mixrig::model
