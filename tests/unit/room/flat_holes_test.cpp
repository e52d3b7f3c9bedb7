// SPDX-License-Identifier: Apache-2.0
// A wall with a hole in its depth.
#include "host/room/background/flat_holes.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"

namespace mixrig::model {
namespace {

constexpr geometry::Pinhole kHoleView{{160, 128}, 150, 150, 79.5, 63.5};
constexpr double kWallOffset_m = 4;

/// A slanted wall: z + 0.3 x = kWallOffset_m.
float wall_z_m(int x) {
  return static_cast<float>(kWallOffset_m / (1 + 0.3 * (x - kHoleView.cx_px) / kHoleView.fx_px));
}

using Depth = std::function<float(int x, int y)>;

Image<float> drawn(const Depth& depth_m) {
  Image<float> out(kHoleView.size_px);
  for (const auto [x, y] : test::each_pixel({0, 0}, {out.width(), out.height()}))
    out.at(x, y) = depth_m(x, y);
  return out;
}

/// `around` with a hole in columns x0 .. x1 - 1 and rows y0 .. y1 - 1.
Image<float> with_hole(int x0, int y0, int x1, int y1, const Depth& around) {
  return drawn(
      [&](int x, int y) { return x >= x0 && x < x1 && y >= y0 && y < y1 ? 0 : around(x, y); });
}

float wall(int x, int) { return wall_z_m(x); }

TEST(FlatHoles, AMirrorLiesInTheWallAroundIt) {
  Image<float> depth_m = with_hole(40, 30, 90, 80, wall);
  depth_m.at(60, 50) = 1;  // noise
  const Image<float> found = with_flat_holes(depth_m, kHoleView);
  for (const auto [x, y] : test::each_pixel({0, 0}, {160, 128}))
    EXPECT_NEAR(found.at(x, y), x == 60 && y == 50 ? 1 : wall_z_m(x), 1e-3) << x << ' ' << y;
}

TEST(FlatHoles, AThingBeforeItsBorderDoesNotBendIt) {
  const Image<float> depth_m = with_hole(
      40, 30, 90, 80, [](int x, int y) { return x >= 84 && x < 94 && y >= 10 ? 3 : wall_z_m(x); });
  const Image<float> found = with_flat_holes(depth_m, kHoleView);
  for (const auto [x, y] : test::each_pixel({40, 30}, {90, 80}))
    EXPECT_NEAR(found.at(x, y), wall_z_m(x), 0.01) << x << ' ' << y;
}

TEST(FlatHoles, WhatLiesInNoPlaneStaysUnknown) {
  const Image<float> corner = with_hole(
      40, 30, 90, 80, [](int x, int) { return 4 + 0.04F * static_cast<float>(std::abs(x - 65)); });
  EXPECT_EQ(with_flat_holes(corner, kHoleView).at(60, 60), 0);
}

TEST(FlatHoles, WhatLeavesThePictureOrIsSmallStaysUnknown) {
  EXPECT_EQ(with_flat_holes(with_hole(40, 30, 90, 128, wall), kHoleView).at(60, 60), 0);
  EXPECT_EQ(with_flat_holes(with_hole(40, 30, 45, 35, wall), kHoleView).at(42, 32), 0);
  EXPECT_EQ(with_flat_holes(Image<float>(kHoleView.size_px), kHoleView).at(60, 60), 0);
}

}  // namespace
}  // namespace mixrig::model
