// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/lamp_intensity.h"

#include <gtest/gtest.h>

namespace mixrig::lights {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

FoundLamp lamp_of_size(const Vector2d& size_m) {
  FoundLamp lamp;
  lamp.size_m = size_m;
  return lamp;
}

/// Areas of 1 and 3; measured: 6 red and 2 white.
class LampIntensity : public ::testing::Test {
 protected:
  LampIntensity() {
    lamps_ = {lamp_of_size({1, 1}), lamp_of_size({2, 1.5})};
    measured_.verdict = estimation::Verdict::ok();
    measured_.value.intensity = {{6, 0, 0}, {2, 2, 2}};
  }
  std::vector<FoundLamp> lamps_;
  estimation::Estimate<RoomLight> measured_, none_;
};

TEST_F(LampIntensity, IsAsMeasured) {
  EXPECT_EQ(lamp_intensities(lamps_, measured_, {}), measured_.value.intensity);
}

TEST_F(LampIntensity, IsSharedByAreaWhereNothingTells) {
  const auto found = lamp_intensities(lamps_, none_, {});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(found[0].isApprox(Vector3f::Constant(kAssumedIntensity / 4)));
  EXPECT_TRUE(found[1].isApprox(Vector3f::Constant(kAssumedIntensity * 3 / 4)));
}

TEST_F(LampIntensity, IsAssumedInTheRatioOfABracket) {
  const auto found = lamp_intensities(lamps_, none_, std::vector<double>{9, 1});
  EXPECT_TRUE(found[0].isApprox(Vector3f::Constant(kAssumedIntensity * 3 / 4)));
  EXPECT_TRUE(found[1].isApprox(Vector3f::Constant(kAssumedIntensity / 4)));
}

/// The sum of the luminance and each lamp's colour stay; 9 times 1 and 1 times 3: three to one.
TEST_F(LampIntensity, ABracketSharesOutWhatWasMeasured) {
  const auto found = lamp_intensities(lamps_, measured_, std::vector<double>{9, 1});
  constexpr float kRed = 0.2126F;  // of red in luminance, Rec. 709
  const float all = 6 * kRed + 2;
  EXPECT_TRUE(found[0].isApprox(Vector3f(0.75F * all / kRed, 0, 0), 1e-5F)) << found[0];
  EXPECT_TRUE(found[1].isApprox(Vector3f::Constant(0.25F * all), 1e-5F)) << found[1];
}

TEST_F(LampIntensity, WhatABracketAloneSeesIsWhite) {
  measured_.value.intensity[1].setZero();
  const auto found = lamp_intensities(lamps_, measured_, std::vector<double>{9, 1});
  EXPECT_GT(found[1].x(), 0);
  EXPECT_EQ(found[1], Vector3f::Constant(found[1].x()));
}

TEST_F(LampIntensity, PointsHaveTheSameWithoutABracket) {
  lamps_ = {lamp_of_size({0, 0}), lamp_of_size({0, 0})};
  const auto found = lamp_intensities(lamps_, none_, {});
  EXPECT_EQ(found[0], Vector3f::Constant(kAssumedIntensity / 2));
  EXPECT_EQ(found[1], found[0]);
}

TEST_F(LampIntensity, NoLampNoIntensity) { EXPECT_TRUE(lamp_intensities({}, none_, {}).empty()); }

}  // namespace
}  // namespace mixrig::lights
