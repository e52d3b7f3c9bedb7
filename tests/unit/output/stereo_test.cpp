// SPDX-License-Identifier: Apache-2.0
// Stereo pairs of a scene of planes, against the same scene seen from both eyes.
#include "host/output/streams/stereo.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"

namespace mixrig::output {
namespace {

constexpr Size kStereoView{160, 4};
constexpr double kFx_px = 200, kWall_m = 4, kNear_m = 1.6;

/// A pattern on a plane, by its place in metres.
Rgb8 pattern(double x_m, bool near) {
  const auto wave = [](double v) {
    return static_cast<std::uint8_t>(std::lround(127 + 100 * std::sin(v)));
  };
  return near ? Rgb8{220, wave(20 * x_m), 20} : Rgb8{20, wave(8 * x_m), wave(5 * x_m + 1)};
}
bool on_near(double x_m) { return std::abs(x_m) < 0.15; }

/// Seen from an eye that is moved to the right; the plane at `screen_m` stays where it is.
Rgb8 seen(double x_px, double eye_x_m, double screen_m, bool with_near) {
  const auto place = [&](double z_m) {
    // x = fx (X - e) / z + fx e / screen + c
    return (x_px - 79.5) / kFx_px * z_m + eye_x_m - eye_x_m * z_m / screen_m;
  };
  if (with_near && on_near(place(kNear_m))) return pattern(place(kNear_m), true);
  return pattern(place(kWall_m), false);
}

struct Pictures {
  Image<Rgb8> color{kStereoView}, wall{kStereoView};
  Image<float> depth{kStereoView}, wall_depth{kStereoView};
  Pictures() {
    for (const auto [x, y] : test::each_pixel(kStereoView)) {
      color.at(x, y) = seen(x, 0, 3, true), wall.at(x, y) = seen(x, 0, 3, false);
      depth.at(x, y) =
          static_cast<float>(on_near((x - 79.5) / kFx_px * kNear_m) ? kNear_m : kWall_m);
      wall_depth.at(x, y) = static_cast<float>(kWall_m);
    }
  }
};

int difference(const Rgb8& a, const Rgb8& b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

TEST(StereoPair, IsWhatBothEyesSeeAlsoBehindTheEdge) {
  const Pictures in;
  StereoPair pair({kFx_px, 0.065, 3, 1e9});
  Image<Rgb8> out;
  const auto counts = pair.draw({in.color, in.depth}, {in.wall, in.wall_depth}, out);
  ASSERT_EQ(out.size(), (Size{320, 4}));
  int wrong = 0;
  for (const auto [x, eye] : test::each_pixel({4, 0}, {kStereoView.width - 4, 2}))
    wrong +=
        difference(out.at(eye * 160 + x, 1), seen(x, eye == 0 ? -0.0325 : 0.0325, 3, true)) > 12;
  // Each eye has two edges, which lie on whole pixels by chance alone.
  EXPECT_LE(wrong, 8);
  EXPECT_GT(counts.behind, 0U);
  // Guessed are only the sides of the picture, which no camera saw: the disparity there is 1.1 px.
  EXPECT_LT(counts.guessed, 2U * 4U * 3U);
  EXPECT_EQ(counts.seen + counts.behind + counts.guessed, 2U * 640U);
}

TEST(StereoPair, WithoutARoomTheHoleIsTheFartherNeighbour) {
  const Pictures in;
  StereoPair pair({kFx_px, 0.065, 3, 1e9});
  Image<Rgb8> out;
  const auto counts = pair.draw({in.color, in.depth}, {}, out);
  EXPECT_EQ(counts.behind, 0U);
  EXPECT_GT(counts.guessed, 0U);
  for (int x = 0; x < 320; ++x) {
    const Rgb8 c = out.at(x, 2);
    EXPECT_TRUE(c.r > 150 || c.b > 20 || c.r < 60) << "no colour between the planes at " << x;
  }
}

TEST(StereoPair, DisparityIsCut) {
  const Pictures in;
  StereoPair pair({kFx_px, 0.065, 3, 0});
  Image<Rgb8> out;
  (void)pair.draw({in.color, in.depth}, {}, out);
  for (int x = 0; x < 160; ++x) {
    EXPECT_EQ(difference(out.at(x, 0), in.color.at(x, 0)), 0) << x;
    EXPECT_EQ(difference(out.at(160 + x, 0), in.color.at(x, 0)), 0) << x;
  }
}

TEST(StereoPair, UnknownDepthIsNotTorn) {
  Pictures in;
  for (int y = 0; y < kStereoView.height; ++y) in.depth.at(20, y) = in.depth.at(21, y) = 0;
  StereoPair pair({kFx_px, 0.065, 3, 1e9});
  Image<Rgb8> out;
  const auto counts = pair.draw({in.color, in.depth}, {in.wall, in.wall_depth}, out);
  EXPECT_LT(counts.guessed, 24U);
  Image<float> none{kStereoView};
  const auto nothing = pair.draw({in.color, none}, {}, out);
  EXPECT_EQ(nothing.seen, 2U * 640U) << "all of it on the screen";
}

}  // namespace
}  // namespace mixrig::output
