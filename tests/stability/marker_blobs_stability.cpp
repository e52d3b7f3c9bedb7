// SPDX-License-Identifier: Apache-2.0
// Bias of marker centres over the phase within a pixel, by radius and threshold.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "host/estimation/marker_blobs.h"
#include "tests/support/random_geometry.h"

namespace mixrig::stability {
namespace {

/// A disc blurred by half a pixel, each pixel integrated over 8x8 points.
Image<std::uint8_t> disc(double x0, double y0, double radius, double peak, double noise,
                         test::RandomGeometry& random) {
  Image<std::uint8_t> picture({32, 32}, 0);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      double sum = 0;
      for (int sub = 0; sub < 64; ++sub) {
        const double px = x + (sub % 8 - 3.5) / 8, py = y + (sub / 8 - 3.5) / 8;
        sum += 0.5 * std::erfc((std::hypot(px - x0, py - y0) - radius) / (0.5 * std::sqrt(2.0)));
      }
      const double grey = 10 + peak * sum / 64 + noise * random.normal();
      picture.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
  return picture;
}

TEST(MarkerBlobStability, BiasStaysBelowAHundredthOfAPixelFromRadiusTwo) {
  std::printf(
      "marker blobs: greatest bias of the centre over the phase, px; scatter over claimed "
      "sigma (noise 2 grey)\nradius px");
  const int thresholds[] = {30, 60, 120};
  for (int threshold : thresholds) std::printf("   threshold %3d", threshold);
  std::printf("\n");
  for (double radius : {1.0, 1.5, 2.0, 3.0, 5.0}) {
    std::printf("%9.1f", radius);
    for (int threshold : thresholds) {
      test::RandomGeometry random(7);
      double bias = 0, squared = 0;
      int count = 0;
      for (int phase = 0; phase < 10; ++phase) {
        Eigen::Vector2d mean = Eigen::Vector2d::Zero();
        const Eigen::Vector2d truth(15 + 0.1 * phase, 15.35);
        constexpr int kShots = 20;
        for (int shot = 0; shot < kShots; ++shot) {
          const auto blobs = estimation::find_marker_blobs(
              disc(truth.x(), truth.y(), radius, 200, 2, random), {threshold, 1, 1000, 2, 3});
          ASSERT_EQ(blobs.size(), 1u);
          const Eigen::Vector2d error = blobs[0].value.centre_px - truth;
          mean += error / kShots;
          squared += error.x() * error.x() / blobs[0].covariance(0, 0);
          ++count;
        }
        bias = std::max(bias, mean.norm());
      }
      std::printf("    %6.4f (%4.2f)", bias, std::sqrt(squared / count));
      if (radius >= 2 && threshold <= 60) EXPECT_LT(bias, 0.01) << radius << " " << threshold;
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace mixrig::stability
