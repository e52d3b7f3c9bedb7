// SPDX-License-Identifier: Apache-2.0
// Pixels worked out by hand.
#include "host/judge/measure/slip.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

constexpr IdealView kView{1000, 900, 640, 512};

TEST(PixelOf, ShowsAPointBeforeACameraThatIsNotTurned) {
  const auto px = pixel_of({1.5, -0.5, 7}, {{0, 0, 0, 1}, {1, 0, 2}}, kView);
  ASSERT_TRUE(px);  // 0.5 right, 0.5 up, 5 away
  EXPECT_NEAR((*px)[0], 640 + 1000 * 0.1, 1e-9);
  EXPECT_NEAR((*px)[1], 512 - 900 * 0.1, 1e-9);
}

TEST(PixelOf, TurnsWithTheCamera) {
  // A camera upright in a world with z up that looks along y: x stays, camera y = -z, z = y. That
  // is a turn by -90 degrees about x.
  const double h = std::sqrt(0.5);
  const CameraPlace upright{{-h, 0, 0, h}, {0, 0, 1.5}};
  const auto px = pixel_of({0.4, 4, 0.5}, upright, kView);
  ASSERT_TRUE(px);
  EXPECT_NEAR((*px)[0], 640 + 1000 * 0.1, 1e-9);
  EXPECT_NEAR((*px)[1], 512 + 900 * 0.25, 1e-9);
  // The camera turned by another 36.87 degrees to the left about the world's z (3-4-5 triangle): it
  // looks along (-0.6, 0.8, 0), its right is (0.8, 0.6, 0).
  const double half = 0.5 * std::asin(0.6), c = std::cos(half), s = std::sin(half);
  const CameraPlace left{{-h * c, -h * s, h * s, h * c}, {0, 0, 1.5}};
  const auto turned = pixel_of({-0.6 * 5 + 0.8, 0.8 * 5 + 0.6, 1.0}, left, kView);
  ASSERT_TRUE(turned);  // 5 away, 1 right, 0.5 down
  EXPECT_NEAR((*turned)[0], 640 + 1000 * 0.2, 1e-9);
  EXPECT_NEAR((*turned)[1], 512 + 900 * 0.1, 1e-9);
}

TEST(PixelOf, HasNoneBehindOrAtTheCamera) {
  EXPECT_FALSE(pixel_of({0, 0, -3}, {}, kView));
  EXPECT_FALSE(pixel_of({0, 0, 0.009}, {}, kView));
  EXPECT_FALSE(pixel_of({0, 0, NAN}, {}, kView));
  EXPECT_TRUE(pixel_of({0, 0, 0.011}, {}, kView));
}

TEST(Within95Pct, IsTheEllipseOfTheChiSquareQuantile) {
  // Independent: 2 px and 3 px. sqrt(5.991) = 2.44765.
  const PixelCovariance apart{4, 9, 0};
  EXPECT_TRUE(within_95_pct({2 * 2.447, 0}, apart));
  EXPECT_FALSE(within_95_pct({2 * 2.449, 0}, apart));
  EXPECT_TRUE(within_95_pct({0, -3 * 2.447}, apart));
  EXPECT_FALSE(within_95_pct({0, -3 * 2.449}, apart));
  // One pixel each way, correlation 0.8: variance 1.8 along the diagonal, 0.2 across it.
  const PixelCovariance slanted{1, 1, 0.8};
  const double h = std::sqrt(0.5);
  EXPECT_TRUE(within_95_pct({3.28 * h, 3.28 * h}, slanted));  // 2.44765 sqrt(1.8) = 3.2838
  EXPECT_FALSE(within_95_pct({3.29 * h, 3.29 * h}, slanted));
  EXPECT_TRUE(within_95_pct({1.09 * h, -1.09 * h}, slanted));  // 2.44765 sqrt(0.2) = 1.0946
  EXPECT_FALSE(within_95_pct({1.10 * h, -1.10 * h}, slanted));
}

TEST(Within95Pct, RefusesACovarianceThatIsNone) {
  EXPECT_FALSE(within_95_pct({0, 0}, {0, 0, 0}));
  EXPECT_FALSE(within_95_pct({0, 0}, {1, 1, 1}));
  EXPECT_FALSE(within_95_pct({0, 0}, {-1, -1, 0}));
  EXPECT_FALSE(within_95_pct({0, 0}, {NAN, 1, 0}));
}

TEST(SlipSums, AreThoseOfTheDistances) {
  SlipSums sums;
  EXPECT_EQ(sums.rms_px(), 0);
  for (const double distance_px : {1.0, 2.0, 2.0}) sums.add(distance_px);
  sums.add(NAN);
  EXPECT_EQ(sums.count(), 3U);
  EXPECT_NEAR(sums.rms_px(), std::sqrt(3.0), 1e-12);
  EXPECT_EQ(sums.max_px(), 2.0);
  EXPECT_NEAR(sums.quantile_px(0.25), 1.5, 0.003);
}

}  // namespace
}  // namespace mixrig::measure
