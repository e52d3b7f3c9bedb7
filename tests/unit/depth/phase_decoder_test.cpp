// SPDX-License-Identifier: Apache-2.0
// Raw pictures by the formula of a phase-shift camera.
#include "host/capture/depth/phase_decoder.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"
#include "tests/support/kinect2_pictures.h"

namespace mixrig::depth {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr std::array<double, 3> kRanges_m{1.875, 9.375, 1.25};
constexpr std::array<double, 3> kContrasts{1 / 1.322581, 1, 1 / 1.612903};

struct Surface {
  double way_m = 0, light = 0;  ///< half of the way of the light; counts
};

struct Scene {
  test::Kinect2Pictures pictures;
  device::Kinect2Offsets offsets;
  device::Kinect2Infrared lens{365, 365, 255.5, 211.5, {}};
  PhaseDepth out;

  Scene() {
    for (std::size_t f = 0; f < 3; ++f) {
      offsets[f].reset(device::kKinect2Depth);
      for (const auto [x, y] : test::each_pixel({0, 0}, {512, 424}))
        offsets[f].at(x, y) = static_cast<std::uint16_t>(3000 * (f + 1) + 7 * x + y);
    }
  }
  void put(int x, int y, const std::vector<Surface>& surfaces) {
    for (std::size_t f = 0; f < 3; ++f)
      for (int k = 0; k < 3; ++k) {
        double value = 0;
        for (const Surface& s : surfaces)
          value += kContrasts[f] * s.light *
                   std::cos(kTwoPi * s.way_m / kRanges_m[f] + kTwoPi * k / 3 -
                            0.000031 * std::numbers::pi * offsets[f].at(x, y));
        pictures.put(static_cast<int>(3 * f) + k, x, y, test::kinect2_code(value));
      }
  }
  void fill(int x0, int x1, const std::function<std::vector<Surface>(int x, int y)>& at) {
    for (const auto [x, y] : test::each_pixel({x0, 100}, {x1, 112})) put(x, y, at(x, y));
  }
  void decode() { PhaseDecoder(kinect2_phase_camera(lens, offsets)).decode(pictures.bytes, out); }
};

TEST(PhaseDecoder, FindsDistancesOverTheWholeRange) {
  const std::array<double, 9> ways_m{0.4, 0.9, 1.3, 2.0, 3.1, 3.9, 5.6, 7.4, 9.2};
  Scene scene;
  for (std::size_t i = 0; i < ways_m.size(); ++i)
    scene.fill(40 * static_cast<int>(i) + 20, 40 * static_cast<int>(i) + 40, [&](int, int) {
      return std::vector{Surface{ways_m[i], 1500}};
    });
  scene.decode();
  for (std::size_t i = 0; i < ways_m.size(); ++i)
    for (const auto [x, y] : test::each_pixel({40 * static_cast<int>(i) + 22, 102},
                                              {40 * static_cast<int>(i) + 38, 110})) {
      ASSERT_EQ(scene.out.state.at(x, y), PixelState::kGood) << ways_m[i];
      // The light source is 45 mm left of the lens: |P| + |P - source| is twice the way.
      const double u = (x - 255.5) / 365, v = (y - 211.5) / 365, s = std::hypot(1, u, v);
      const double r = static_cast<double>(scene.out.distance_m.at(x, y)),
                   to_source = std::hypot(r * u / s + 0.045, r * v / s, r / s);
      ASSERT_NEAR(0.5 * (r + to_source), ways_m[i], 0.002) << x << " " << y;
      ASSERT_NEAR(scene.out.amplitude.at(x, y), 4 * 1500, 60);
      ASSERT_GT(scene.out.confidence.at(x, y), kLeastConfidence);
    }
}

TEST(PhaseDecoder, TellsDarkSaturatedAndMixedApart) {
  Scene scene;
  const auto wall = [](int, int) { return std::vector{Surface{2.5, 800}}; };
  scene.fill(20, 60, wall), scene.fill(100, 140, wall), scene.fill(180, 220, wall);
  scene.put(40, 105, {{2.5, 2}});
  scene.pictures.put(4, 120, 105, 1024);
  scene.put(200, 105, {{2.5, 400}, {1.6, 500}});
  scene.decode();
  EXPECT_EQ(scene.out.state.at(40, 105), PixelState::kDark);
  EXPECT_EQ(scene.out.distance_m.at(40, 105), 0);
  EXPECT_EQ(scene.out.state.at(120, 105), PixelState::kSaturated);
  EXPECT_EQ(scene.out.distance_m.at(120, 105), 0);
  EXPECT_EQ(scene.out.state.at(200, 105), PixelState::kMixed);
  EXPECT_GT(scene.out.distance_m.at(200, 105), 0);
  for (const int x : {40, 120, 200}) {
    EXPECT_LT(scene.out.confidence.at(x, 105), kLeastConfidence);
    EXPECT_EQ(scene.out.state.at(x + 4, 105), PixelState::kGood);
  }
}

TEST(PhaseDecoder, AFlyingPixelBetweenTwoSurfacesIsMixedWhateverItsPhasesSay) {
  Scene scene;
  // A strip one pixel wide, whose phases are those of one surface in the middle.
  scene.fill(20, 80, [](int x, int) {
    return std::vector{Surface{x < 50 ? 1.5 : x == 50 ? 2.1 : 2.7, 900}};
  });
  scene.decode();
  for (int y = 102; y < 110; ++y) {
    EXPECT_EQ(scene.out.state.at(50, y), PixelState::kMixed);
    EXPECT_EQ(scene.out.state.at(49, y), PixelState::kGood);
    EXPECT_EQ(scene.out.state.at(51, y), PixelState::kGood);
  }
}

TEST(PhaseDecoder, SmoothingMixesNoSurfaces) {
  Scene scene;
  scene.fill(20, 80, [](int x, int) { return std::vector{Surface{x < 50 ? 2.5 : 2.7, 900}}; });
  scene.decode();
  const float at_wall = scene.out.distance_m.at(40, 105),
              at_step = scene.out.distance_m.at(49, 105);
  EXPECT_NEAR(at_wall, at_step, 0.003);
}

/// A wall with light that came over others: many ways, the longer the weaker.
std::vector<Surface> with_tail(double way_m, double share, double further_m) {
  constexpr int kWays = 400;
  std::vector<Surface> all{{way_m, 900}};
  double sum = 0;
  for (int i = 0; i < kWays; ++i) sum += std::exp(-0.02 * (i + 0.5));
  for (int i = 0; i < kWays; ++i)
    all.push_back(
        {way_m + 0.02 * (i + 0.5) * further_m, 900 * share / sum * std::exp(-0.02 * (i + 0.5))});
  return all;
}

TEST(PhaseDecoder, BouncedLightIsTakenOffByWhatItDoesToTheFrequencies) {
  const std::vector<std::pair<double, double>> tails{
      {0.2, 0.2}, {0.5, 0.3}, {0.7, 0.6}, {1.2, 0.4}};
  Scene scene;
  for (std::size_t i = 0; i < tails.size(); ++i)
    scene.fill(60 * static_cast<int>(i) + 20, 60 * static_cast<int>(i) + 50,
               [&](int, int) { return with_tail(2.5, tails[i].first, tails[i].second); });
  PhaseDecoder decoder(kinect2_phase_camera(scene.lens, scene.offsets));
  PhaseDepth as_seen;
  decoder.set_bounced_light(false);
  decoder.decode(scene.pictures.bytes, as_seen);
  decoder.set_bounced_light(true);
  decoder.decode(scene.pictures.bytes, scene.out);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < tails.size(); ++i)
    for (int x = 60 * static_cast<int>(i) + 30; x < 60 * static_cast<int>(i) + 40; ++x) {
      const auto off = [&](const PhaseDepth& out) {  // the light source moves it by 2 mm at most
        return std::abs(static_cast<double>(out.distance_m.at(x, 106)) - 2.5);
      };
      EXPECT_GT(off(as_seen), 0.01) << i;
      // The first tail is too weak to be distinguished from a camera's harmonics.
      EXPECT_LT(off(scene.out), (i == 0 ? 1.02 : 0.75) * off(as_seen)) << i << " " << off(as_seen);
      before += off(as_seen), after += off(scene.out);
      EXPECT_EQ(scene.out.state.at(x, 106), PixelState::kGood) << i;
    }
  EXPECT_LT(after, 0.55 * before);
}

}  // namespace
}  // namespace mixrig::depth
