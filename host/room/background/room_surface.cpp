// SPDX-License-Identifier: Apache-2.0
#include "host/room/background/room_surface.h"

#include <algorithm>

namespace mixrig::model {
namespace {

/// Number of values from each one to the end of its reach; `visit(first, count)` in rising order.
template <typename Visit>
void each_run(std::span<const float> sorted_m, const Visit& visit) {
  std::size_t end = 0;
  for (std::size_t i = 0; i < sorted_m.size(); ++i) {
    const float most_m = sorted_m[i] + surface_reach_m(sorted_m[i]);
    while (end < sorted_m.size() && sorted_m[end] <= most_m) ++end;
    visit(i, end - i);
  }
}

}  // namespace

float surface_reach_m(float depth_m) { return 0.15F + 0.005F * depth_m * depth_m; }

RoomSurface room_surface(std::span<float> depths_m) {
  RoomSurface room;
  if (depths_m.empty()) return room;
  std::sort(depths_m.begin(), depths_m.end());
  std::size_t most = 0, first = 0, count = 0;
  each_run(depths_m, [&](std::size_t, std::size_t run) { most = std::max(most, run); });
  each_run(depths_m, [&](std::size_t at, std::size_t run) {
    if (4 * run >= 3 * most) first = at, count = run;
  });
  room.center_m = depths_m[first + count / 2];
  room.reach_m = surface_reach_m(room.center_m);
  for (const float z_m : depths_m) {
    room.count += room.has(z_m);
    room.nearer += z_m < room.center_m - room.reach_m;
  }
  return room;
}

}  // namespace mixrig::model
