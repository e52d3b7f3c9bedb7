// SPDX-License-Identifier: Apache-2.0
// Patches of a box whose walls have a formula.
#include "host/pose/tracker/patch_map.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/textured_box.h"

namespace mixrig::tracking {
namespace {

using test::TexturedBox;

PatchMapOptions coarse_options() { return {0.009, 4, 400}; }

double off_the_walls_m(const Eigen::Vector3d& p) {
  return std::abs(p.norm() - TexturedBox::distance_m(Eigen::Vector3d::Zero(), p.normalized()));
}

TEST(PatchMap, PixelsOfPatchesLieOnTheWalls) {
  Crew crew(2);
  const PatchMap map = make_patch_map(TexturedBox().panorama(), coarse_options(), crew);
  ASSERT_EQ(map.levels.size(), 4U);
  EXPECT_GT(map.levels[0].size(), 300U);
  EXPECT_LE(map.levels[0].size(), 440U);
  for (const Patch& p : map.levels[0]) {
    for (std::size_t k = 0; k < kPatchPixels; ++k)
      EXPECT_LT(off_the_walls_m(
                    (p.centre_m + Eigen::Vector3f(p.x_m[k], p.y_m[k], p.z_m[k])).cast<double>()),
                0.02);
    EXPECT_LT(p.normal.dot(p.centre_m), 0);
    EXPECT_NEAR(p.normal.cwiseAbs().maxCoeff(), 1, 0.35);
    EXPECT_FLOAT_EQ(p.sigma_m, 0.001F);
  }
}

TEST(PatchMap, DerivativesSayHowGreyValuesChange) {
  Crew crew(2);
  const TexturedBox box;
  const PatchMap map = make_patch_map(box.panorama(), coarse_options(), crew);
  double product = 0, first = 0, second = 0;
  for (const Patch& p : map.levels[0]) {
    const auto grey = [&](const Eigen::Vector3f& at) {
      return 255 * box.grey(Eigen::Vector3d::Zero(), at.cast<double>().normalized());
    };
    const double change = grey(p.centre_m + 0.5F * p.u_m) - grey(p.centre_m - 0.5F * p.u_m);
    // The mean of the four pixels in the middle.
    const double mean = 0.25 * (p.grey_u[14] + p.grey_u[15] + p.grey_u[20] + p.grey_u[21]);
    product += change * mean, first += change * change, second += mean * mean;
  }
  EXPECT_GT(product / std::sqrt(first * second), 0.8);
}

TEST(PatchMap, HoldsNothingOfBareWallsAndOfWhatIsNotKnown) {
  Crew crew(1);
  for (const auto& level :
       make_patch_map(TexturedBox(1, 0).panorama(180), coarse_options(), crew).levels)
    EXPECT_TRUE(level.empty());
  model::Panorama half = TexturedBox().panorama(180);
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 180; ++x) half.distance_m.at(x, y) = 0, half.color.at(x, y) = {};
  for (const auto& level : make_patch_map(half, coarse_options(), crew).levels) {
    EXPECT_FALSE(level.empty());
    // Columns of the left half look to azimuths above 0: x is negative.
    for (const Patch& p : level) EXPECT_GT(p.centre_m.x(), -0.4F * p.range_m);
  }
}

TEST(PatchMap, WhatStandsBetweenHides) {
  // A pillar 1 m ahead of the origin, seen from there; the walls are 3 m away.
  PatchMap map;
  map.distance_m.reset({360, 180}, 3);
  for (int y = 0; y < 180; ++y)
    for (int x = 170; x < 190; ++x) map.distance_m.at(x, y) = 1;
  EXPECT_FALSE(map.hidden({0, 0, 0}, {0, 0.9F, 0}));
  EXPECT_FALSE(map.hidden({0.5F, 0, 0}, {0.5F, 2.5F, 0}));
  EXPECT_TRUE(map.hidden({1.2F, 1.5F, 0}, {-1.2F, 1.5F, 0}));  // past the pillar, behind it
  map.distance_m.fill(0);
  EXPECT_FALSE(map.hidden({1.2F, 1.5F, 0}, {-1.2F, 1.5F, 0}));
}

}  // namespace
}  // namespace mixrig::tracking
