// SPDX-License-Identifier: Apache-2.0
// A matte that is steady: whole frames of the cpu back end, a person before a wall.
#include <cmath>
#include <cstdlib>

#include "host/render/cpu/compositor_cpu.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kSteadyView{160, 128}, kSteadyTof{80, 64};

std::uint8_t shade(double value) { return static_cast<std::uint8_t>(std::lround(value)); }

/// A patterned wall 4 m away; a person in a coat nearly like it, 2 m away, 40 x 80 pixels. Edges of
/// depth are off by a ToF pixel, by another one in each frame.
struct SteadyScene {
  SteadyScene()
      : setup(plain_setup(kSteadyView, 160, kSteadyTof, 80)),
        wall_m(kSteadyView, 4),
        sigma_m(kSteadyView, 0.004F),
        color(kSteadyView),
        color_sigma(kSteadyView, 0.01F),
        plate(kSteadyView),
        depth(kSteadyTof) {
    for (int y = 0; y < kSteadyView.height; ++y)
      for (int x = 0; x < kSteadyView.width; ++x) {
        const auto light = static_cast<float>(std::pow(wall(x, y) / 255, 2.2));
        color.at(x, y) = {light, light, light};
      }
    setup.background = {wall_m, sigma_m, color, color_sigma};
  }
  static double wall(int x, int y) { return 120 + 20 * std::sin(0.3 * x) * std::sin(0.25 * y); }
  static bool is_person(int x, int y, int x0, int grow_px = 0) {
    return x >= x0 - grow_px && x < x0 + 40 + grow_px && y >= 30 - grow_px && y < 110 + grow_px;
  }
  /// The person's left side at x0, or nobody; the camera or a lamp makes all brighter by `gain`.
  void draw(int number, int x0, bool there = true, double gain = 1) {
    for (int y = 0; y < kSteadyView.height; ++y)
      for (int x = 0; x < kSteadyView.width; ++x) {
        const int noise = (x * 7919 + y * 104729 + number * 1299709) % 5 - 2;
        const double coat = 105 + 15 * std::sin(0.5 * (x - x0)) * std::sin(0.4 * y);
        const double seen = there && is_person(x, y, x0) ? coat : wall(x, y);
        plate.at(x, y) = {shade(gain * seen + noise), shade(gain * seen + noise),
                          shade(gain * seen - noise)};
      }
    for (int y = 0; y < kSteadyTof.height; ++y)
      for (int x = 0; x < kSteadyTof.width; ++x) {
        const int off = (y * 31 + number * 17) % 3 - 1;
        depth.at(x, y) = there && is_person(2 * (x + off), 2 * y, x0) ? 2.0F : 4.0F;
      }
  }
  std::unique_ptr<render::Compositor> compositor(bool steady) {
    setup.key.steady = steady;
    auto made = render::make_cpu_compositor(setup, 1);
    EXPECT_TRUE(made);
    out.wanted = render::kMatte;
    return std::move(*made);
  }
  void compose(render::Compositor& compositor, int number) {
    EXPECT_TRUE(compositor.compose(
        {.plate = plate, .tof_depth_m = depth, .world_from_target = pose, .time_s = 0.04 * number},
        out));
  }
  /// Pixels of the matte that are people by a tenth, further than 4 px from the person.
  int ghosts(int x0, bool there = true) const {
    int count = 0;
    for (int y = 0; y < kSteadyView.height; ++y)
      for (int x = 0; x < kSteadyView.width; ++x)
        count += out.matte.at(x, y) > 25 && !(there && is_person(x, y, x0, 4));
    return count;
  }
  render::CompositorSetup setup;
  Image<float> wall_m, sigma_m;
  Image<Rgbf> color;
  Image<float> color_sigma;
  Image<Rgb8> plate;
  Image<float> depth;
  geometry::Pose pose;
  render::FrameOutput out;
};

/// Mean square change of the matte (0 to 1) from frame to frame over a person who stands still.
double flicker(bool steady) {
  SteadyScene scene;
  const auto compositor = scene.compositor(steady);
  double sum = 0;
  Image<std::uint8_t> before;
  for (int n = 0; n < 12; ++n) {
    scene.draw(n, 60);
    scene.compose(*compositor, n);
    if (n >= 4)
      for (int y = 0; y < kSteadyView.height; ++y)
        for (int x = 0; x < kSteadyView.width; ++x)
          sum += std::pow((scene.out.matte.at(x, y) - before.at(x, y)) / 255.0, 2);
    before = scene.out.matte;
  }
  return sum;
}

TEST(Steady, halves_the_flicker_of_a_person_who_stands) {
  const double without = flicker(false), with = flicker(true);
  EXPECT_GT(without, 1) << "depth does flicker";
  EXPECT_LE(with, 0.25 * without) << "of the squares";
}

TEST(Steady, leaves_no_ghost_of_who_starts_turns_stops_and_leaves) {
  SteadyScene scene;
  const auto steady = scene.compositor(true), alone = scene.compositor(false);
  const int way[] = {60, 60, 60, 64, 70, 77, 84, 84, 80, 74, 74, 74};
  int number = 0;
  for (const int x0 : way) {
    scene.draw(++number, x0);
    scene.compose(*alone, number);
    const int ghosts = scene.ghosts(x0);
    scene.compose(*steady, number);
    EXPECT_LE(scene.ghosts(x0), ghosts + 8) << number;
  }
  scene.draw(++number, 0, false);
  scene.compose(*steady, number);
  EXPECT_EQ(scene.ghosts(0, false), 0) << "gone";
}

/// The camera's gain or a lamp changes: the history is discarded, and the matte is that of the
/// frame alone.
TEST(Steady, forgets_where_the_light_changed) {
  SteadyScene scene;
  const auto steady = scene.compositor(true), alone = scene.compositor(false);
  for (int n = 1; n <= 4; ++n) {
    scene.draw(n, 60, true, n == 4 ? 1.4 : 1.0);
    scene.compose(*alone, n);
    const Image<std::uint8_t> matte = scene.out.matte;
    scene.compose(*steady, n);
    if (n < 4) continue;
    for (int y = 0; y < kSteadyView.height; ++y)
      for (int x = 0; x < kSteadyView.width; ++x)
        ASSERT_NEAR(scene.out.matte.at(x, y), matte.at(x, y), 12) << x << "," << y;
  }
}

/// A moved camera, a pause, and one frame twice.
TEST(Steady, of_another_pose_or_time_nothing_joins_and_a_frame_again_is_the_same) {
  SteadyScene scene;
  const auto steady = scene.compositor(true), alone = scene.compositor(false);
  const auto both = [&](int number) {
    scene.compose(*alone, number);
    const Image<std::uint8_t> matte = scene.out.matte;
    scene.compose(*steady, number);
    for (int y = 0; y < kSteadyView.height; ++y)
      for (int x = 0; x < kSteadyView.width; ++x)
        if (matte.at(x, y) != scene.out.matte.at(x, y)) return false;
    return true;
  };
  scene.draw(1, 60);
  EXPECT_TRUE(both(1)) << "the first one";
  scene.draw(2, 60);
  EXPECT_FALSE(both(2)) << "joins";
  const Image<std::uint8_t> once = scene.out.matte;
  const long before = allocations;
  scene.compose(*steady, 2);
  EXPECT_EQ(allocations, before);
  for (int y = 0; y < kSteadyView.height; ++y)
    for (int x = 0; x < kSteadyView.width; ++x) ASSERT_EQ(once.at(x, y), scene.out.matte.at(x, y));
  scene.draw(3, 60);
  EXPECT_TRUE(both(30)) << "after a pause";
  scene.pose.translation_m = {0.1, 0, 0};
  scene.draw(4, 60);
  EXPECT_TRUE(both(31)) << "another pose";
}

}  // namespace
}  // namespace mixrig::test
