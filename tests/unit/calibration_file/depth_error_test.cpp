// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/capture/calibration_file/depth_sigma.h"

namespace mixrig::calibration_file {
namespace {

constexpr Size kSize{101, 51};
const Eigen::Vector2d kMiddle(50, 25);

TEST(DepthErrorModel, IsTheNaturalCubicSpline) {
  DepthError error;
  error.knots_m = {0, 1, 2};
  error.error_m = {0, 1, 0};
  // By hand: curvature -3 at the middle knot, zero at the ends: y(x) = 1.5 x - 0.5 x^3 on 0..1.
  for (double x : {0.0, 0.25, 0.5, 0.9, 1.0})
    EXPECT_NEAR(error.at(x, 0, kMiddle, kSize), 1.5 * x - 0.5 * x * x * x, 1e-14);
  EXPECT_NEAR(error.at(1.75, 0, kMiddle, kSize), error.at(0.25, 0, kMiddle, kSize), 1e-14);
}

TEST(DepthErrorModel, BeyondTheKnotsItIsWhatItIsAtTheEnd) {
  DepthError error;
  error.knots_m = {0, 1, 2};
  error.error_m = {0.5, 1, 0};
  EXPECT_EQ(error.at(-2, 0, kMiddle, kSize), 0.5);
  EXPECT_EQ(error.at(3, 0, kMiddle, kSize), 0);
}

TEST(DepthErrorModel, AddsTermsOfAmplitudeAndPlace) {
  DepthError error;
  error.knots_m = {1, 2};
  error.error_m = {0, 0};
  error.amplitude_m = 3;
  error.place_m = {1, 10, 100, 1000, 10000};
  EXPECT_NEAR(error.at(1.5, 0, kMiddle, kSize), 0, 1e-12);
  EXPECT_NEAR(error.at(1.5, 6, kMiddle, kSize), 0.5, 1e-12);
  EXPECT_NEAR(error.at(1.5, 0, {100, 0}, kSize), 1 - 10 + 100 - 1000 + 10000, 1e-9);
}

TEST(DepthErrorModel, ItsSigmaIsThatOfTheSpline) {
  DepthError error;
  error.knots_m = {0, 1, 2};
  error.error_m = {0, 1, 0};
  EXPECT_EQ(depth_sigma_m(error, 1), 0) << "not known";
  error.covariance = Eigen::MatrixXd::Zero(9, 9);
  error.covariance(1, 1) = 0.0004;
  EXPECT_NEAR(depth_sigma_m(error, 1), 0.02, 1e-12);
  // Computed by hand for a unit value at the middle knot: 1.5 x - 0.5 x^3 on 0..1.
  EXPECT_NEAR(depth_sigma_m(error, 0.5), 0.02 * (0.75 - 0.0625), 1e-12);
  // A constant error of all knots is one of each distance.
  error.covariance.topLeftCorner<3, 3>().setConstant(0.0009);
  for (const double at_m : {0.0, 0.3, 1.7, 4.0})
    EXPECT_NEAR(depth_sigma_m(error, at_m), 0.03, 1e-12);
}

}  // namespace
}  // namespace mixrig::calibration_file
