// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/calibration_file/calibration.h"

namespace mixrig::calibration_file {
namespace {

constexpr Size kSize{101, 51};
const Eigen::Vector2d kMiddle(50, 25);

TEST(DepthError, IsTheNaturalCubicSpline) {
  DepthError error;
  error.knots_m = {0, 1, 2};
  error.error_m = {0, 1, 0};
  // By hand: curvature -3 at the middle knot, zero at the ends: y(x) = 1.5 x - 0.5 x^3 on 0..1.
  for (double x : {0.0, 0.25, 0.5, 0.9, 1.0})
    EXPECT_NEAR(error.at(x, 0, kMiddle, kSize), 1.5 * x - 0.5 * x * x * x, 1e-14);
  EXPECT_NEAR(error.at(1.75, 0, kMiddle, kSize), error.at(0.25, 0, kMiddle, kSize), 1e-14);
}

TEST(DepthError, BeyondTheKnotsItIsWhatItIsAtTheEnd) {
  DepthError error;
  error.knots_m = {0, 1, 2};
  error.error_m = {0.5, 1, 0};
  EXPECT_EQ(error.at(-2, 0, kMiddle, kSize), 0.5);
  EXPECT_EQ(error.at(3, 0, kMiddle, kSize), 0);
}

TEST(DepthError, AddsTermsOfAmplitudeAndPlace) {
  DepthError error;
  error.knots_m = {1, 2};
  error.error_m = {0, 0};
  error.amplitude_m = 3;
  error.place_m = {1, 10, 100, 1000, 10000};
  EXPECT_NEAR(error.at(1.5, 0, kMiddle, kSize), 0, 1e-12);
  EXPECT_NEAR(error.at(1.5, 6, kMiddle, kSize), 0.5, 1e-12);
  EXPECT_NEAR(error.at(1.5, 0, {100, 0}, kSize), 1 - 10 + 100 - 1000 + 10000, 1e-9);
}

}  // namespace
}  // namespace mixrig::calibration_file
