// SPDX-License-Identifier: Apache-2.0
// Shifts between drawn pictures: with noise, without texture, and with a moving person.
#include "host/capture/live/sweep/picture_shift.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::live {
namespace {

/// Waves of several directions, shifted, with noise.
Image<float> waves(double x_px, double y_px, double noise, unsigned seed, double height = 40) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  Image<float> out(Size{160, 120});
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const double u = x - x_px, v = y - y_px;
      out.at(x, y) = static_cast<float>(
          100 + height * (std::sin(0.31 * u + 0.1 * v) + std::cos(0.27 * v - 0.05 * u)) +
          noise * normal(random));
    }
  return out;
}

TEST(PictureShift, IsFoundWithASigmaThatHolds) {
  int within = 0;
  constexpr int kTrials = 40;
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    const PictureShift shift =
        shift_between(waves(0, 0, 4, 2 * seed), waves(0.3, -0.2, 4, 2 * seed + 1));
    EXPECT_NEAR(shift.x_px, 0.3, 0.03);
    EXPECT_NEAR(shift.y_px, -0.2, 0.03);
    if (std::abs(shift.y_px + 0.2) < 3 * shift.sigma_y_px + 0.01) ++within;
    EXPECT_LT(shift.sigma_x_px, 0.02);
    EXPECT_FALSE(shift.is_none(0.1));
  }
  EXPECT_GE(within, kTrials - 2);
}

TEST(PictureShift, IsNoneBetweenTwoPicturesOfAStillView) {
  for (unsigned seed = 0; seed < 20; ++seed)
    EXPECT_TRUE(shift_between(waves(0, 0, 8, 2 * seed), waves(0, 0, 8, 2 * seed + 1)).is_none(0));
}

TEST(PictureShift, NoiseAloneTellsNothing) {
  const PictureShift shift = shift_between(waves(0, 0, 5, 1, 0), waves(0, 0, 5, 2, 0));
  EXPECT_EQ(shift.sigma_x_px, 0);
  EXPECT_EQ(shift.sigma_y_px, 0);
  EXPECT_TRUE(shift.is_none(0.1));
  EXPECT_TRUE(shift_between(Image<float>({160, 120}, 0), waves(0, 0, 5, 2)).is_none(0));
  EXPECT_TRUE(shift_between({}, waves(0, 0, 5, 2)).is_none(0));
}

TEST(PictureShift, SomebodyWhoMovesInAThirdOfThePictureDoesNotMatter) {
  Image<float> a = waves(0, 0, 2, 1), b = waves(0, 0, 2, 2);
  const Image<float> walker = waves(0.8, 0.1, 2, 3);
  for (int y = 0; y < 120; ++y) std::copy_n(walker.row(y) + 20, 53, b.row(y) + 20);
  EXPECT_TRUE(shift_between(a, b).is_none(0.1));
}

TEST(PictureShift, UnknownDepthIsLeftOut) {
  Image<float> a = waves(0, 0, 2, 1), b = waves(0.4, 0, 2, 2);
  for (int y = 0; y < 120; ++y)
    for (int x = y % 5; x < 160; x += 13) a.at(x, y) = 0;
  EXPECT_NEAR(shift_between(a, b).x_px, 0.4, 0.05);
}

TEST(PictureShift, LuminanceIsAboveZero) {
  Image<Rgb8> plate(Size{2, 1});
  plate.at(1, 0) = {10, 20, 30};
  Image<float> out;
  luminance_of(plate, out);
  EXPECT_EQ(out.at(0, 0), 1);
  EXPECT_EQ(out.at(1, 0), 21);
}

}  // namespace
}  // namespace mixrig::live
