// SPDX-License-Identifier: Apache-2.0
// Two depth cameras on both sides of the colour camera, against the exact world.
#include "host/render/cpu/warp/second_depth.h"

#include <cmath>
#include <memory>

#include "host/render/cpu/compositor_cpu.h"
#include "tests/gl/room_setup.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

Image<float> warped(const RoomSetup& room, const render::FrameInput& frame) {
  auto compositor = render::make_cpu_compositor(room.setup, 2);
  EXPECT_TRUE(compositor) << to_line(compositor.error());
  render::FrameOutput output;
  output.wanted = render::kWarpedDepth;
  const auto done = (*compositor)->compose(frame, output);
  EXPECT_TRUE(done) << to_line(done.error());
  return output.warped_depth_m;
}

/// The frame without the second depth camera.
render::FrameInput first_alone(const RoomSetup& room) {
  render::FrameInput frame = room.frame();
  frame.tof2_depth_m = {};
  return frame;
}

/// Pixels without depth or off by more than 10 cm, over those that only the second camera sees, and
/// over all others.
struct WrongPixels {
  int hidden = 0, hidden_wrong = 0, others_wrong = 0;
  WrongPixels(const RoomSetup& room, const Image<float>& depth_m) {
    const Camera ideal{room.setup.view.size_px, room.setup.view.fx_px, {0, 0, 0}, 0};
    Image<float> truth;
    Image<std::uint8_t> person;
    render_truth(room.scene, ideal, truth, person);
    const auto first = seen_by_tof(room.scene, ideal, room.tof, truth);
    const auto second = seen_by_tof(room.scene, ideal, room.tof2, truth);
    for (int y = 0; y < truth.height(); ++y)
      for (int x = 0; x < truth.width(); ++x) {
        const float z = depth_m.at(x, y);
        const bool wrong = !(std::abs(z - truth.at(x, y)) < 0.1F) || !(z > 0);
        const bool only_second = first.at(x, y) == 0 && second.at(x, y) != 0;
        hidden += only_second;
        (only_second ? hidden_wrong : others_wrong) += wrong;
      }
  }
};

TEST(SecondDepth, sees_what_people_hide_from_the_first) {
  const RoomSetup room({.objects = false, .lamps = false, .second_tof = true});
  const WrongPixels one(room, warped(room, first_alone(room)));
  const WrongPixels two(room, warped(room, room.frame()));
  ASSERT_GT(one.hidden, 500);
  EXPECT_GT(one.hidden_wrong, 0.6 * one.hidden);
  EXPECT_LT(two.hidden_wrong, 0.25 * two.hidden);
  EXPECT_LE(two.others_wrong, 1.02 * one.others_wrong);
}

/// Root mean square of the depth's error over a wall.
double wall_error_m(const Image<float>& depth_m, float wall_m) {
  double sum = 0;
  int count = 0;
  for (int y = 8; y < depth_m.height() - 8; ++y)
    for (int x = 8; x < depth_m.width() - 8; ++x)
      if (const float z = depth_m.at(x, y); z > 0) sum += (z - wall_m) * (z - wall_m), ++count;
  return std::sqrt(sum / count);
}

/// Two ideal cameras 15 cm apart before a wall at 3 m.
struct Wall {
  static constexpr float kWall_m = 3;
  static constexpr Size kTof{64, 48};
  Wall() : setup(plain_setup({128, 96}, 120, kTof, 50)) {
    setup.target_from_tof.translation_m = {0.075, 0, 0};
    render::SecondTof& second = setup.tof2.emplace();
    second.model = setup.tof;
    second.noise = setup.noise;
    second.target_from_tof.translation_m = {-0.075, 0, 0};
    plate.reset(setup.view.size_px);
    first.reset(kTof, kWall_m), second_m.reset(kTof, kWall_m);
  }
  static void add_noise(Image<float>& depth_m, unsigned seed, float sigma_m) {
    for (int y = 0; y < depth_m.height(); ++y)
      for (int x = 0; x < depth_m.width(); ++x) {
        seed = seed * 1664525U + 1013904223U;
        const float uniform = static_cast<float>(seed >> 8) / 16777216.0F - 0.5F;
        depth_m.at(x, y) += 3.46F * sigma_m * uniform;
      }
  }
  Image<float> drawn(bool both) const {
    auto compositor = render::make_cpu_compositor(setup, 1);
    EXPECT_TRUE(compositor) << to_line(compositor.error());
    render::FrameOutput output;
    output.wanted = render::kWarpedDepth;
    const auto done = (*compositor)
                          ->compose({.plate = plate,
                                     .tof_depth_m = first,
                                     .world_from_target = {},
                                     .tof2_depth_m = both ? second_m.view() : ImageView<float>()},
                                    output);
    EXPECT_TRUE(done) << to_line(done.error());
    return output.warped_depth_m;
  }
  /// Depth at the view pixel of a ToF pixel of the first camera at depth z.
  static float at(const Image<float>& view_m, int x, int y, float z) {
    const float u = 120 * ((static_cast<float>(x) - 31.5F) / 50 + 0.075F / z) + 63.5F;
    const float v = 120 * (static_cast<float>(y) - 23.5F) / 50 + 47.5F;
    return view_m.at(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
  }
  render::CompositorSetup setup;
  Image<Rgb8> plate;
  Image<float> first, second_m;
};

TEST(SecondDepth, agreeing_depths_are_averaged_without_a_bias_to_the_camera) {
  Wall wall;
  Wall::add_noise(wall.first, 7, 0.008F);
  Wall::add_noise(wall.second_m, 8, 0.008F);
  const Image<float> one = wall.drawn(false), two = wall.drawn(true);
  EXPECT_LT(wall_error_m(two, Wall::kWall_m), 0.85 * wall_error_m(one, Wall::kWall_m));
  double mean = 0;
  int count = 0;
  for (int y = 8; y < 88; ++y)
    for (int x = 8; x < 120; ++x) mean += two.at(x, y) - Wall::kWall_m, ++count;
  EXPECT_NEAR(mean / count, 0, 0.001);
}

TEST(SecondDepth, a_better_known_depth_weighs_more) {
  Wall wall;
  wall.setup.tof2->noise.floor_m = 5 * wall.setup.noise.floor_m + 0.05;
  wall.second_m.fill(3.03F);
  EXPECT_NEAR(Wall::at(wall.drawn(true), 32, 24, 3), 3, 0.003);
}

TEST(SecondDepth, what_the_other_looks_through_is_not_there) {
  Wall wall;
  for (int y = 20; y < 24; ++y)
    for (int x = 30; x < 34; ++x) wall.first.at(x, y) = 1.8F;  // no stray pixel by itself
  EXPECT_NEAR(Wall::at(wall.drawn(false), 31, 22, 1.8F), 1.8, 0.01);
  const Image<float> two = wall.drawn(true);
  for (int y = 30; y < 60; ++y)
    for (int x = 40; x < 90; ++x) EXPECT_NEAR(two.at(x, y), 3, 0.01) << x << "," << y;
}

TEST(SecondDepth, what_the_other_cannot_see_stays) {
  Wall wall;
  // A thing at 2 m that a board at 1 m hides from the second camera.
  for (int y = 20; y < 26; ++y)
    for (int x = 40; x < 46; ++x) wall.first.at(x, y) = 2;
  for (int y = 10; y < 40; ++y)
    for (int x = 40; x < 60; ++x) wall.second_m.at(x, y) = 1;
  EXPECT_NEAR(Wall::at(wall.drawn(true), 43, 23, 2), 2, 0.01);
  // Nor is it refuted by what the second one does not know.
  for (int y = 10; y < 40; ++y)
    for (int x = 40; x < 60; ++x) wall.second_m.at(x, y) = 0;
  EXPECT_NEAR(Wall::at(wall.drawn(true), 43, 23, 2), 2, 0.01);
}

TEST(SecondDepth, a_frame_without_it_is_that_of_the_first_alone) {
  const RoomSetup two({.second_tof = true}), one(RoomSetup::Options{});
  const Image<float> without = warped(two, first_alone(two)), alone = warped(one, one.frame());
  for (int y = 0; y < alone.height(); ++y)
    for (int x = 0; x < alone.width(); ++x) ASSERT_EQ(without.at(x, y), alone.at(x, y));
}

TEST(SecondDepth, pictures_of_another_size_are_refused) {
  Wall wall;
  wall.second_m.reset({63, 48}, 3.0F);
  auto compositor = render::make_cpu_compositor(wall.setup, 1);
  ASSERT_TRUE(compositor);
  render::FrameOutput output;
  const auto done = (*compositor)
                        ->compose({.plate = wall.plate,
                                   .tof_depth_m = wall.first,
                                   .world_from_target = {},
                                   .tof2_depth_m = wall.second_m},
                                  output);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().context.find("second depth picture is 63 x 48"), std::string::npos)
      << done.error().context;
}

}  // namespace
}  // namespace mixrig::test
