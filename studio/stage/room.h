// SPDX-License-Identifier: Apache-2.0
// A room of the size of Schiller et al. 2010, table 1, with furniture and lamps.
#pragma once

#include "studio/stage/mesh.h"
#include "studio/studio.h"

namespace mixrig::studio {

/// Inner dimensions along x, y and z (Schiller et al. 2010, table 1).
inline constexpr float kRoomX_m = 5.263F, kRoomY_m = 4.328F, kRoomZ_m = 2.987F;

/// Furniture that depends on the scenario.
struct RoomPlan {
  bool seat = false;        ///< a chair for the person
  Vec3 seat_foot{0, 0, 0};  ///< position on the floor, below its centre
  float seat_yaw_rad = 0;
  bool desk_chair = true;    ///< reaches into the capture volume
  bool moved_chair = false;  ///< the chair of the desk stands 0.9 m away and turned
  float door_rad = 0;        ///< into the room; 0 closed
  bool guest_seat = false;   ///< a second chair
  Vec3 guest_foot{4.35F, 1.0F, 0};
  bool mirror = false;       ///< on the far wall, in place of the middle picture
  bool window = false;       ///< a pane of glass before the night in that place, without mirror
  bool thin_things = false;  ///< thin poles and a table seen at a grazing angle
};
inline constexpr float kSeatHeight_m = 0.45F;

Mesh build_room(const RoomPlan& plan);
/// Four ceiling panels; `level` scales their intensity.
std::vector<Panel> ceiling_lamps(float level);

/// The room without walls, floor, ceiling and lamps: these are the convex hull of the room, so they
/// shade nothing.
Mesh furniture_of(const Mesh& room);

}  // namespace mixrig::studio
