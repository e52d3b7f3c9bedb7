// SPDX-License-Identifier: Apache-2.0
// Registration of drawn rectangles whose shift is known.
#include "host/judge/measure/registration.h"

#include <array>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"

namespace mixrig::measure {
namespace {

constexpr Size kShot{320, 240};

/// Boxes 1 to 2 m away before a wall at 3 m. In the plate they are shifted, and wider by 2 `wider`.
Registration registration_of(int right, int down, int wider, bool boxes_in_plate = true) {
  std::mt19937 random(9);
  RegistrationMeasure measure;
  for (int shot = 0; shot < 3; ++shot) {
    Image<float> depth_m(kShot);
    Image<Rgb8> plate(kShot);
    depth_m.fill(3.0F);
    for (const auto [x, y] : test::each_pixel(kShot)) {
      const auto gray =
          static_cast<std::uint8_t>(100 + random() % 16 + (random() % 97 == 0 ? 60 : 0));
      plate.at(x, y) = {gray, gray, gray};
    }
    for (int box = 0; box < 4; ++box) {
      const int x0 = 40 + 60 * box + 3 * shot, y0 = 50 + 20 * box, w = 30, h = 60;
      for (const auto [x, y] : test::each_pixel({x0, y0}, {x0 + w, y0 + h}))
        depth_m.at(x, y) = 1.0F + 0.3F * static_cast<float>(box);
      for (int y = y0; y < y0 + h; ++y)  // the hole beside a near surface
        for (int x = x0 + w; x < x0 + w + 4; ++x) depth_m.at(x, y) = 0;
      if (!boxes_in_plate) continue;
      for (const auto [x, y] : test::each_pixel({x0 + right - wider, y0 + down - wider},
                                                {x0 + w + right + wider, y0 + h + down + wider}))
        plate.at(x, y) = {230, static_cast<std::uint8_t>(220 + random() % 16), 225};
    }
    measure.add(depth_m, plate);
  }
  return measure.result();
}

TEST(Registration, IsTheShiftBetweenDepthStepsAndEdges) {
  constexpr std::array<std::array<int, 3>, 5> kShifts{
      {{0, 0, 0}, {3, -2, 0}, {-5, 4, 0}, {0, 0, 2}, {2, 1, -1}}};
  for (const auto& [right, down, wider] : kShifts) {
    const Registration found = registration_of(right, down, wider);
    EXPECT_TRUE(found.known());
    EXPECT_GT(found.matched_share, 0.6);
    EXPECT_NEAR(found.right_px, right, 0.51) << right;
    EXPECT_NEAR(found.down_px, down, 0.51) << down;
    EXPECT_NEAR(found.outside_px, wider, 0.51) << wider;
    if (right == 0 && down == 0 && wider == 0) {
      EXPECT_EQ(found.median_px, 0);
    }
  }
}

TEST(Registration, GrowsWithTheShiftAndIsNotKnownOfOtherPictures) {
  EXPECT_LT(registration_of(0, 0, 0).median_px, registration_of(2, 1, 0).median_px);
  EXPECT_LT(registration_of(2, 1, 0).median_px, registration_of(5, 4, 0).median_px);
  EXPECT_FALSE(registration_of(0, 0, 0, false).known());
}

TEST(Registration, WithoutStepsThereIsNone) {
  RegistrationMeasure measure;
  Image<float> flat(kShot);
  flat.fill(2.0F);
  measure.add(flat, Image<Rgb8>(kShot));
  EXPECT_EQ(measure.result().steps, 0);
  EXPECT_EQ(RegistrationMeasure().result().steps, 0);
}

}  // namespace
}  // namespace mixrig::measure
