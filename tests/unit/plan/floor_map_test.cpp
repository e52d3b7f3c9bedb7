// SPDX-License-Identifier: Apache-2.0
#include "extras/people/plan/floor_map.h"

#include <gtest/gtest.h>

namespace mixrig::plan {
namespace {

/// A floor of 4 x 3 m with a box of 1 x 1 x 0.7 m at (1, 1), and a lamp above.
std::vector<RoomPoint> room_with_a_box() {
  std::vector<RoomPoint> points;
  for (float x = 0.01F; x < 4; x += 0.02F)
    for (float y = 0.01F; y < 3; y += 0.02F) {
      const bool box = x > 1 && x < 2 && y > 1 && y < 2;
      points.push_back({{x, y, box ? 0.7F : 0.01F}, {100, 50, 20}});
      if (x > 3 && y > 2) points.push_back({{x, y, 2.6F}, {255, 255, 255}});
    }
  return points;
}

TEST(FloorMap, tells_the_free_floor_from_what_stands_on_it) {
  const FloorMap map = map_floor(room_with_a_box());
  EXPECT_NEAR(map.free_m2(), 4 * 3 - 1, 0.3);
  const auto top = [&](double x, double y) {
    const Eigen::Vector2i cell = map.cell_of({x, y});
    return map.top_m.at(cell.x(), cell.y());
  };
  EXPECT_NEAR(top(1.5, 1.5), 0.7F, 1e-6);
  EXPECT_EQ(top(0.5, 0.5), 0);
  EXPECT_EQ(top(3.5, 2.5), 0);  // the lamp hangs high
  EXPECT_EQ(map.color.at(10, 10), (Rgb8{100, 50, 20}));
}

TEST(FloorMap, what_was_not_seen_is_not_free) {
  std::vector<RoomPoint> points = room_with_a_box();
  std::erase_if(points, [](const RoomPoint& p) { return p.at_m.x() > 2.5F && p.at_m.x() < 3; });
  const FloorMap map = map_floor(points);
  const Eigen::Vector2i cell = map.cell_of({2.75, 0.5});
  EXPECT_EQ(map.top_m.at(cell.x(), cell.y()), FloorMap::kUnknown);
  EXPECT_EQ(not_free(map).at(cell.x(), cell.y()), 255);
  EXPECT_TRUE(map_floor({}).top_m.empty());
}

TEST(FloorMap, grown_reaches_as_far_as_it_says) {
  Image<std::uint8_t> one({21, 21});
  one.at(10, 10) = 255;
  const Image<std::uint8_t> disc = grown(one, 5);
  EXPECT_EQ(disc.at(15, 10), 255);
  EXPECT_EQ(disc.at(13, 14), 255);
  EXPECT_EQ(disc.at(14, 14), 0);
  EXPECT_EQ(disc.at(16, 10), 0);
}

}  // namespace
}  // namespace mixrig::plan
