// SPDX-License-Identifier: Apache-2.0
// The room of paper A, table 1, with its furniture and lamps.
#pragma once

#include "host/studio/mesh.h"
#include "host/studio/studio.h"

namespace mixrig::studio {

/// Inside measures, x y z (paper A, table 1).
inline constexpr float kRoomX_m = 5.263F, kRoomY_m = 4.328F, kRoomZ_m = 2.987F;

/// What stands in the room beside the usual furniture.
struct RoomPlan {
  bool seat = false;        ///< a chair for the person
  Vec3 seat_foot{0, 0, 0};  ///< below its centre
  float seat_yaw_rad = 0;
  bool thin_things = false;  ///< thin poles and a table seen at a grazing angle
};
inline constexpr float kSeatHeight_m = 0.45F;

Mesh build_room(const RoomPlan& plan);
/// Four ceiling panels; `level` scales them.
std::vector<Panel> ceiling_lamps(float level);

}  // namespace mixrig::studio
