// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/depth_correction.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"

namespace mixrig::depth {
namespace {

using calibration_file::DepthError;

const geometry::CameraModel kTof{{{32, 24}, 28, 29, 15, 12}, {}};

/// A sensor's own law, which knots 0.1 m apart follow to some micrometres.
double law_m(double true_m) { return 0.015 * std::sin(3 * true_m) + 0.004 * true_m; }

DepthError error_of_law() {
  DepthError error;
  for (double true_m = 0.4; true_m < 6.05; true_m += 0.1) {
    error.knots_m.push_back(true_m + law_m(true_m));
    error.error_m.push_back(law_m(true_m));
  }
  return error;
}

TEST(DepthCorrection, UndoesASensorsLawAlongTheRay) {
  for (const bool is_distance : {true, false}) {
    const DepthCorrection correction(error_of_law(), kTof, is_distance);
    Image<float> depth({32, 24});
    for (double true_m = 0.6; true_m < 5.5; true_m += 0.37) {
      for (const auto [x, y] : test::each_pixel({0, 0}, {32, 24})) {
        // By hand: a pixel's ray is longer than its depth by this factor.
        const double ray = is_distance ? 1 : std::hypot((x - 15) / 28.0, (y - 12) / 29.0, 1.0);
        depth.at(x, y) = static_cast<float>((true_m + law_m(true_m)) / ray);
      }
      correction.apply(depth, {});
      for (const auto [x, y] : test::each_pixel({0, 0}, {32, 24})) {
        const double ray = is_distance ? 1 : std::hypot((x - 15) / 28.0, (y - 12) / 29.0, 1.0);
        ASSERT_NEAR(depth.at(x, y) * ray, true_m, 2e-5) << x << " " << y;
      }
    }
  }
}

TEST(DepthCorrection, IsTheErrorItselfAlsoBeyondTheKnotsAndWithAllTerms) {
  DepthError error = error_of_law();
  error.amplitude_m = 0.7;
  error.place_m = {0.001, -0.002, 0.003, 0.004, -0.005};
  const DepthCorrection correction(error, kTof, true);
  const Image<float> amplitude({32, 24}, 350.0F);
  for (float measured_m : {0.2F, 0.45F, 1.234F, 3.9F, 6.0F, 9.0F}) {
    Image<float> depth({32, 24}, measured_m);
    correction.apply(depth, amplitude);
    for (const auto& [x, y] : {std::pair(0, 0), {31, 23}, {7, 20}})
      EXPECT_NEAR(depth.at(x, y), measured_m - error.at(measured_m, 350, {x, y}, {32, 24}), 1e-5)
          << measured_m;
  }
}

TEST(DepthCorrection, WhatIsUnknownStays) {
  DepthError error;
  error.knots_m = {1, 2};
  error.error_m = {0.5, 0.5};
  const DepthCorrection correction(error, kTof, false);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Image<float> depth({32, 24}, 0.0F);
  depth.at(1, 0) = -1.0F;
  depth.at(2, 0) = kInfinity;
  depth.at(3, 0) = std::nanf("");
  depth.at(4, 0) = 0.1F;
  depth.at(5, 0) = std::numeric_limits<float>::max();
  correction.apply(depth, {});
  EXPECT_EQ(depth.at(0, 0), 0.0F);
  EXPECT_EQ(depth.at(1, 0), -1.0F);
  EXPECT_EQ(depth.at(2, 0), kInfinity);
  EXPECT_TRUE(std::isnan(depth.at(3, 0)));
  EXPECT_EQ(depth.at(4, 0), 0.0F) << "nothing can lie behind the camera";
}

}  // namespace
}  // namespace mixrig::depth
