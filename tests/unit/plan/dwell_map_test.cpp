// SPDX-License-Identifier: Apache-2.0
#include "extras/people/plan/dwell_map.h"

#include <gtest/gtest.h>

namespace mixrig::plan {
namespace {

TEST(DwellMap, sums_the_time_in_each_cell_on_both_sides_of_the_origin) {
  DwellMap map;
  for (int i = 0; i < 25; ++i) map.add({0.31, 0.02}, 0.04);
  map.add({-0.05, -0.12}, 0.5);
  map.add({-0.01, -0.19}, 0.25);
  const DwellGrid grid = map.grid();
  EXPECT_NEAR(grid.corner_m.x(), -0.1, 1e-12);
  EXPECT_NEAR(grid.corner_m.y(), -0.2, 1e-12);
  ASSERT_EQ(grid.time_s.size(), (Size{5, 3}));
  float sum_s = 0;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) sum_s += grid.time_s.at(x, y);
  EXPECT_FLOAT_EQ(sum_s, 1.75F);
  EXPECT_FLOAT_EQ(grid.time_s.at(0, 0), 0.75F);
  EXPECT_FLOAT_EQ(grid.time_s.at(4, 2), 1);
}

TEST(DwellMap, nobody_leaves_an_empty_grid) { EXPECT_TRUE(DwellMap().grid().time_s.empty()); }

}  // namespace
}  // namespace mixrig::plan
