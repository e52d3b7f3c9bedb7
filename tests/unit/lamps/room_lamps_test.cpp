// SPDX-License-Identifier: Apache-2.0
// A lamp and a white wall, which a room's plates show alike, and its light does not.
#include "host/room/lamps/room_lamps.h"

#include <gtest/gtest.h>

#include "tests/unit/lamps/drawn_box.h"

namespace mixrig::lights {
namespace {

/// A lamp of 12 in the left half and a wall of 1.3 in the right one; both are white in the plates.
model::Panorama lamp_and_wall(bool light) {
  model::Panorama p = test::DrawnBox().panorama();
  const Size size = p.color.size();
  if (light) p.light.reset(size), p.light_saturated.reset(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const int row = y - size.height / 2;
      const bool in_rows = row > -12 && row < 12;
      const bool lamp = in_rows && x > size.width / 4 - 12 && x < size.width / 4 + 12;
      const bool wall = in_rows && x > 3 * size.width / 4 - 12 && x < 3 * size.width / 4 + 12;
      const bool white = lamp || wall;
      p.color.at(x, y) = white ? Rgb8{255, 255, 255} : Rgb8{90, 90, 90};
      if (!light) continue;
      const std::uint16_t half = half_of_float(lamp ? 12.0F : wall ? 1.3F : 0.1F);
      p.light.at(x, y) = {half, half, half};
    }
  return p;
}

TEST(RoomLamps, AWhiteWallIsNoCandidateWhereTheRoomHasLight) {
  const RoomSurfaces plates(lamp_and_wall(false), {}), light(lamp_and_wall(true), {});
  EXPECT_EQ(view_of_room(plates).regions.size(), 2U);
  const auto regions = view_of_room(light).regions;
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_LT(regions[0].direction.x(), -0.9) << "the lamp, to the left";
}

}  // namespace
}  // namespace mixrig::lights
