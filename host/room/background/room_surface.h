// SPDX-License-Identifier: Apache-2.0
// Which of the depths that frames measured at a pixel are those of the room.
#pragma once

#include <cmath>
#include <span>

namespace mixrig::model {

/// Values of one pixel that belong to the room: those within reach_m of center_m.
struct RoomSurface {
  float center_m = 0, reach_m = 0;
  int count = 0;   ///< values of the room; 0: none was given
  int nearer = 0;  ///< values before it: people and things that come and go
  bool has(float depth_m) const { return std::abs(depth_m - center_m) <= reach_m; }
};

/// Largest distance between values of one surface: more than a depth camera's noise, less than
/// people stand from what is behind them.
float surface_reach_m(float depth_m);

/// The surface that most values share; a farther one with at least three quarters as many is taken
/// instead, since nobody sees through a wall, but people leave. `depths_m` holds known depths and
/// gets sorted. Pure.
RoomSurface room_surface(std::span<float> depths_m);

}  // namespace mixrig::model
