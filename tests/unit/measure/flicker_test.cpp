// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/flicker.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

/// A person left of a vertical border.
Image<std::uint8_t> half_plane(int border_x) {
  Image<std::uint8_t> matte({64, 16});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < border_x; ++x) matte.at(x, y) = 255;
  return matte;
}

TEST(MatteFlicker, OfOneFrameIsUnknown) {
  MatteFlicker flicker;
  flicker.add(half_plane(20), half_plane(20));
  EXPECT_EQ(flicker.still(), std::nullopt);
  EXPECT_EQ(flicker.all(), std::nullopt);
}

TEST(MatteFlicker, OfAMatteThatIsWrongAndSteadyIsZero) {
  MatteFlicker flicker;
  for (int i = 0; i < 3; ++i) flicker.add(half_plane(23), half_plane(20));
  EXPECT_EQ(flicker.still(), 0.0);
  EXPECT_EQ(flicker.all(), 0.0);
}

TEST(MatteFlicker, OfABorderThatJumpsToAndFroIsTheShareOfTheBand) {
  MatteFlicker flicker;
  for (int i = 0; i < 5; ++i) flicker.add(half_plane(i % 2 == 0 ? 20 : 21), half_plane(20));
  // The border lies between two columns, both of which are in the band: 2 (1 + kBand_px) columns
  // wide, of which one jumps by 1.
  EXPECT_NEAR(*flicker.still(), std::sqrt(1.0 / (2 * (1 + kBand_px))), 1e-12);
  EXPECT_NEAR(*flicker.all(), *flicker.still(), 1e-12);
}

TEST(MatteFlicker, OfAMatteThatMovesWithTheTruthIsZero) {
  MatteFlicker flicker;
  for (int i = 0; i < 5; ++i) flicker.add(half_plane(20 + i), half_plane(20 + i));
  EXPECT_EQ(flicker.still(), 0.0);
  EXPECT_EQ(flicker.all(), 0.0);
}

TEST(MatteFlicker, OfAMatteThatLagsIsSeenWhereThePersonMoves) {
  MatteFlicker lags, stays;
  for (int i = 0; i < 6; ++i) {
    lags.add(half_plane(19 + i), half_plane(20 + i));
    stays.add(half_plane(20), half_plane(20 + i));
  }
  EXPECT_GT(*lags.all(), 0.2) << "one column behind";
  EXPECT_GT(*stays.all(), 0.2);
  EXPECT_EQ(stays.still(), 0.0);
}

TEST(MatteFlicker, FramesOfAnotherSizeBeginAnew) {
  MatteFlicker flicker;
  flicker.add(half_plane(20), half_plane(20));
  const Image<std::uint8_t> other({8, 8});
  flicker.add(other, other);
  EXPECT_EQ(flicker.all(), std::nullopt);
}

}  // namespace
}  // namespace mixrig::measure
