// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/room_mesh.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

constexpr Size kPicture{240, 120};

/// Distances of a cube with walls 2 m from the origin.
Image<float> cube_m() {
  Image<float> picture(kPicture);
  for (int y = 0; y < kPicture.height; ++y)
    for (int x = 0; x < kPicture.width; ++x) {
      const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / kPicture.width);
      const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / kPicture.height);
      const double most = std::max({std::abs(std::sin(azimuth) * std::cos(elevation)),
                                    std::abs(std::cos(azimuth) * std::cos(elevation)),
                                    std::abs(std::sin(elevation))});
      picture.at(x, y) = static_cast<float>(2 / most);
    }
  return picture;
}

/// The cube's eight corners, and two triangles a wall.
const std::vector<float> kCorners{-2, -2, -2, 2, -2, -2, -2, 2, -2, 2, 2, -2,
                                  -2, -2, 2,  2, -2, 2,  -2, 2, 2,  2, 2, 2};
const std::vector<std::uint32_t> kWalls{0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                        2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5};

TEST(MeshErrors, AnExactMeshOfTwelveTrianglesHasNone) {
  const MeshErrors errors = mesh_errors(kCorners, kWalls, cube_m().view());
  EXPECT_LT(errors.max_mm, 0.01);
  EXPECT_EQ(errors.uncovered_pct, 0);
}

TEST(MeshErrors, AWallThatIsOffIsSeen) {
  std::vector<float> moved = kCorners;
  for (const std::size_t corner : {2U, 3U, 6U, 7U}) moved[3 * corner + 1] = 2.01F;  // ahead, 10 mm
  const MeshErrors errors = mesh_errors(moved, kWalls, cube_m().view());
  // Along the ray at most 10 mm over the cosine of 54.7 degrees.
  EXPECT_NEAR(errors.max_mm, 10 * std::sqrt(3), 1);
  EXPECT_GT(errors.p95_mm, 10);
  EXPECT_LT(errors.mean_mm, 5);
}

TEST(MeshErrors, AMissingWallIsNotCovered) {
  const std::vector<std::uint32_t> five(kWalls.begin(), kWalls.end() - 6);
  const MeshErrors errors = mesh_errors(kCorners, five, cube_m().view());
  EXPECT_NEAR(errors.uncovered_pct, 24,
              2);  // a quarter of the azimuths, the wall 35 deg high and more
  EXPECT_LT(errors.max_mm, 0.01);
}

TEST(MeshErrors, TheNearestOfTwoTrianglesCounts) {
  std::vector<float> two = kCorners;
  for (const float c : kCorners) two.push_back(0.5F * c);
  std::vector<std::uint32_t> walls;
  for (const std::uint32_t i : kWalls) walls.push_back(i + 8);
  walls.insert(walls.end(), kWalls.begin(), kWalls.end());
  const MeshErrors errors = mesh_errors(two, walls, cube_m().view());
  EXPECT_GT(errors.mean_mm, 1000);
}

TEST(MeshErrors, NothingIsKnownOfNothing) {
  EXPECT_EQ(mesh_errors({}, {}, Image<float>(kPicture).view()).uncovered_pct, 0);
  EXPECT_EQ(mesh_errors({}, {}, cube_m().view()).uncovered_pct, 100);
}

}  // namespace
}  // namespace mixrig::measure
