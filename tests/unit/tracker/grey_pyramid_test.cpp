// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/grey_pyramid.h"

#include <gtest/gtest.h>

namespace mixrig::tracking {
namespace {

TEST(GreyPyramid, HalvesByTheMeanOfFourPixels) {
  Image<Rgb8> picture({70, 64});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 70; ++x) {
      const auto v = static_cast<std::uint8_t>(x + 2 * y);
      picture.at(x, y) = {v, v, v};
    }
  Crew crew(2);
  GreyPyramid pyramid;
  pyramid.build(picture, 6, crew);
  ASSERT_EQ(pyramid.levels(), 3);  // the next side would be 8 pixels
  EXPECT_EQ(pyramid.level(2).size(), (Size{17, 16}));
  for (int k = 0; k < 3; ++k)
    for (const int x : {0, 5, pyramid.level(k).width() - 1})
      EXPECT_NEAR(pyramid.level(k).at(x, 7), up(x, k) + 2 * up(7, k), 1e-3) << k << " " << x;
}

TEST(GreyPyramid, PlacesGoDownAndUp) {
  EXPECT_DOUBLE_EQ(down(0.5, 1), 0);
  EXPECT_DOUBLE_EQ(up(0, 2), 1.5);
  EXPECT_DOUBLE_EQ(up(down(12.25, 3), 3), 12.25);
}

TEST(GreyPyramid, GreenWeighsMost) {
  Image<Rgb8> picture({16, 16}, {0, 200, 0});
  Crew crew(1);
  GreyPyramid pyramid;
  pyramid.build(picture, 1, crew);
  EXPECT_NEAR(pyramid.level(0).at(3, 3), 0.587F * 200, 1e-3);
}

}  // namespace
}  // namespace mixrig::tracking
