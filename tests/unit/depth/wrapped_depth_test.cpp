// SPDX-License-Identifier: Apache-2.0
// A floor and a wall whose amplitudes have a formula.
#include "host/capture/depth/wrapped_depth.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"

namespace mixrig::depth {
namespace {

constexpr double kRange_m = 7.5;

geometry::CameraModel wide_tof() { return {{{80, 60}, 50, 50, 39.5, 29.5}, {}}; }

/// Pictures of the camera: a wall 4 m ahead above a floor 1.2 m below; light falls with the square
/// of the distance.
struct Pictures {
  Image<float> z_m{{80, 60}}, amplitude{{80, 60}};
  Pictures() {
    for (const auto [x, y] : test::each_pixel({0, 0}, {80, 60}))
      put(x, y, std::min(4.0, 1.2 / std::max(0.01, (y - 29.5) / 50)));
  }
  static double ray(int x, int y) { return std::hypot(1, (x - 39.5) / 50, (y - 29.5) / 50); }
  /// A surface at `z`, measured modulo the range.
  void put(int x, int y, double z, double albedo = 0.5) {
    const double away_m = z * ray(x, y);
    z_m.at(x, y) = static_cast<float>(std::fmod(away_m, kRange_m) / ray(x, y));
    amplitude.at(x, y) = static_cast<float>(5000 * albedo / (away_m * away_m));
  }
};

TEST(WrappedDepth, IsUnknownAndAllElseStays) {
  Pictures seen;
  for (const auto [x, y] : test::each_pixel({30, 10}, {50, 20}))
    seen.put(x, y, 8.2);  // in a mirror: measured as 1 m or so
  for (const auto [x, y] : test::each_pixel({60, 40}, {70, 50}))
    seen.put(x, y, 1.5, 0.02);  // black cloth
  const Pictures before = seen;
  WrappedDepth wrapped(wide_tof(), false);
  EXPECT_EQ(wrapped.remove(seen.z_m, seen.amplitude), 200);
  for (const auto [x, y] : test::each_pixel({0, 0}, {80, 60})) {
    const bool mirror = y >= 10 && y < 20 && x >= 30 && x < 50;
    EXPECT_EQ(seen.z_m.at(x, y), mirror ? 0 : before.z_m.at(x, y)) << x << ' ' << y;
  }
  EXPECT_EQ(wrapped.remove(seen.z_m, seen.amplitude), 0);
}

TEST(WrappedDepth, CountsDistancesAlongTheRay) {
  // A lonely pixel in the corner, whose distance is 1.37 times its z: just above the share of the
  // median by its distance, below by its z.
  for (const bool is_distance : {false, true}) {
    Pictures seen;
    for (const auto [x, y] : test::each_pixel({0, 0}, {80, 60}))
      seen.z_m.at(x, y) = 2, seen.amplitude.at(x, y) = 100;
    seen.amplitude.at(0, 0) = is_distance ? 2.9F : 2.2F;
    WrappedDepth wrapped(wide_tof(), is_distance);
    EXPECT_EQ(wrapped.remove(seen.z_m, seen.amplitude), is_distance ? 1 : 0);
  }
}

TEST(WrappedDepth, LeavesUnknownDepthsAndEmptyPicturesAlone) {
  Pictures seen;
  seen.z_m.at(3, 3) = 0;
  seen.z_m.at(4, 3) = std::numeric_limits<float>::quiet_NaN();
  seen.z_m.at(5, 3) = -1;
  WrappedDepth wrapped(wide_tof(), false);
  EXPECT_EQ(wrapped.remove(seen.z_m, seen.amplitude), 0);
  EXPECT_EQ(seen.z_m.at(5, 3), -1);
  Image<float> dark({80, 60});
  EXPECT_EQ(wrapped.remove(seen.z_m, dark), 0) << "no light at all: no measure";
}

}  // namespace
}  // namespace mixrig::depth
