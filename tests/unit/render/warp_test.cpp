// SPDX-License-Identifier: Apache-2.0
// Warped depth of the back end under test, compared with formulas.
#include <cmath>

#include "tests/unit/render/back_end.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kWarpTof{8, 8}, kWarpView{32, 32};

/// If both cameras stand at one place, ToF pixel x lands at u = 4 x + 1.5 of the view.
WarpedDepth warped_depth(const Image<float>& depth_m, const geometry::Pose& target_from_tof = {},
                         int threads = 1, Size view = kWarpView, double view_f_px = 32) {
  render::CompositorSetup setup = plain_setup(view, view_f_px, depth_m.size(), 8);
  setup.target_from_tof = target_from_tof;
  return warp_depth(render::make_tables(setup), depth_m, threads);
}

TEST(Warp, plane_fills_what_the_tof_camera_sees_and_nothing_else) {
  const WarpedDepth warped = warped_depth(Image<float>(kWarpTof, 2.0F));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const bool inside = x >= 2 && x <= 29 && y >= 2 && y <= 29;
      EXPECT_NEAR(warped.w.at(x, y), inside ? 0.5F : 0.0F, 1e-6F) << x << "," << y;
    }
}

TEST(Warp, tilted_plane_is_exact_between_samples) {
  const auto plane = [](double ray_x, double ray_y) { return 0.5 + 0.05 * ray_x - 0.03 * ray_y; };
  const WarpedDepth warped = warped_depth(make_image<float>(kWarpTof, [&](int x, int y) {
    return static_cast<float>(1 / plane((x - 3.5) / 8, (y - 3.5) / 8));
  }));
  // One ToF pixel in from the border, where smoothing has neighbours on all sides.
  for (int y = 6; y < 26; ++y)
    for (int x = 6; x < 26; ++x)
      EXPECT_NEAR(warped.w.at(x, y), plane((x - 15.5) / 32, (y - 15.5) / 32), 1e-5F);
}

TEST(Warp, step_lies_half_a_tof_pixel_past_the_samples) {
  const WarpedDepth warped =
      warped_depth(make_image<float>(kWarpTof, [](int x, int) { return x < 4 ? 2.0F : 1.0F; }));
  // Samples 3 and 4 land at 13.5 and 17.5: each owns two view pixels of the cut cell.
  const float expected[] = {0.5F, 0.5F, 0.5F, 1.0F, 1.0F, 1.0F};
  for (int x = 13; x <= 18; ++x) {
    EXPECT_NEAR(warped.w.at(x, 15), expected[x - 13], 1e-6F) << x;
    EXPECT_EQ(warped.cut.at(x, 15), x >= 14 && x <= 17) << x;
  }
}

TEST(Warp, pole_of_one_sample_keeps_its_width) {
  const WarpedDepth warped =
      warped_depth(make_image<float>(kWarpTof, [](int x, int) { return x == 4 ? 1.0F : 3.0F; }));
  int width = 0;
  for (int x = 0; x < 32; ++x) width += warped.w.at(x, 15) > 0.9F;
  EXPECT_EQ(width, 4);
}

TEST(Warp, nearest_surface_wins_and_gaps_stay_unknown) {
  // The ToF camera stands 0.25 m to the left: a point at z moves left by 32 x 0.25 / z pixels.
  geometry::Pose pose;
  pose.translation_m = {-0.25, 0, 0};
  const WarpedDepth warped = warped_depth(
      make_image<float>(kWarpTof, [](int x, int) { return x >= 3 && x <= 4 ? 1.0F : 4.0F; }), pose);
  // Near: samples 3 and 4, 13.5 .. 17.5, moved by 8 px, with 1.2 quarters of a cell towards what
  // they cover and 0.2 towards what they open: 3.1 .. 9.9.
  EXPECT_NEAR(warped.w.at(3, 15), 0.25F, 1e-6F);
  EXPECT_NEAR(warped.w.at(4, 15), 1.0F, 1e-6F);
  EXPECT_NEAR(warped.w.at(9, 15), 1.0F, 1e-6F);
  // Far: from 19.5 - 2 on; between lies what only the target camera sees.
  for (int x = 10; x <= 17; ++x) EXPECT_EQ(warped.w.at(x, 15), 0.0F) << x;
  EXPECT_NEAR(warped.w.at(18, 15), 0.25F, 1e-6F);
}

TEST(Warp, reach_is_more_over_what_the_tof_camera_sees_and_less_over_what_it_does_not) {
  // A ToF pixel spans 32 px of the view. The near half ends 16 px past its last sample, which the
  // shift between the cameras moves by `moves_px` against the far half.
  const auto border_px = [](double moves_px) {
    geometry::Pose pose;
    pose.translation_m.x() = moves_px / (256 * (1 - 0.25));
    const auto depth = make_image<float>(kWarpTof, [](int x, int) { return x < 4 ? 1.0F : 4.0F; });
    const WarpedDepth warped = warped_depth(depth, pose, 1, {256, 256}, 256);
    int x = 255;
    while (x > 0 && warped.w.at(x, 128) < 0.9F) --x;
    return x - 256 * pose.translation_m.x();
  };
  const double still_px = border_px(0);
  EXPECT_NEAR(border_px(12) - still_px, 0.2 * 16, 0.75);
  EXPECT_NEAR(border_px(1) - still_px, 0.5 * 0.2 * 16, 0.75);  // half way up the ramp
  EXPECT_NEAR(border_px(-12) - still_px, -0.8 * 16, 0.75);
}

/// Position, in a row of the view, of the border between 2 m (up to ToF column 3) and 4 m, when
/// columns 3 and 4 have the given depths; 0 is no measurement. Midway is 15.5.
float border_with(float third_m, float fourth_m) {
  const Size tof{8, 8}, view{256, 256};  // a ToF pixel spans 32 px
  const WarpedDepth warped =
      warped_depth(make_image<float>(tof,
                                     [&](int x, int) {
                                       if (x == 3) return third_m;
                                       return x == 4 ? fourth_m : x < 4 ? 2.0F : 4.0F;
                                     }),
                   {}, 1, view, 256);
  int x = 255;
  while (x > 0 && warped.w.at(x, 128) < 0.4F) --x;
  // The pixel beside the border is the far surface: no depth is unknown or between the two.
  EXPECT_NEAR(warped.w.at(x + 1, 128), 0.25F, 1e-3F) << third_m << " " << fourth_m;
  return (static_cast<float>(x) + 0.5F - 127.5F) / 32;  // ToF pixels from midway
}

TEST(Warp, border_lies_where_a_flying_pixel_says) {
  EXPECT_NEAR(border_with(2, 4), 0, 0.05);
  // The near surface is four times as bright: at 2.4 m its share is 0.8 x 4 of 0.8 x 4 + 0.2 x 16.
  EXPECT_NEAR(border_with(2.4F, 4), -0.5, 0.05);
  EXPECT_NEAR(border_with(2, 2.4F), 0.5, 0.05);
  EXPECT_NEAR(border_with(2.2F, 4), -0.308, 0.05);  // 0.9 x 4 of 0.9 x 4 + 0.1 x 16
  EXPECT_NEAR(border_with(2, 3), 0.2, 0.05);        // 0.5 x 4 of 0.5 x 4 + 0.5 x 16
}

TEST(Warp, border_lies_in_the_middle_of_a_pixel_that_measured_nothing) {
  EXPECT_NEAR(border_with(0, 4), -0.5, 0.05);
  EXPECT_NEAR(border_with(2, 0), 0.5, 0.05);
}

TEST(Warp, noise_and_stray_values_at_a_step_move_no_border) {
  EXPECT_NEAR(border_with(2.01F, 3.98F), 0, 0.05);
  EXPECT_NEAR(border_with(1.6F, 4), 0, 0.05);  // of neither surface
}

TEST(Warp, surface_seen_from_behind_or_behind_the_camera_draws_nothing) {
  geometry::Pose pose;
  pose.translation_m = {0, 0, -3};
  const WarpedDepth behind = warped_depth(Image<float>(kWarpTof, 2.0F), pose);
  pose.translation_m = {0, 0, 4};
  pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()));
  const WarpedDepth opposite = warped_depth(Image<float>(kWarpTof, 2.0F), pose);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      EXPECT_EQ(behind.w.at(x, y), 0.0F);
      EXPECT_EQ(opposite.w.at(x, y), 0.0F);
    }
}

TEST(Warp, threads_do_not_change_a_bit) {
  const Size tof{40, 30}, view{97, 83};
  geometry::Pose pose;
  pose.translation_m = {0.1, 0.05, 0};
  pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  const auto depth = make_image<float>(tof, [](int x, int y) {
    return (x / 7 + y / 5) % 2 ? 1.0F + 0.02F * static_cast<float>(x) : 3.0F;
  });
  const WarpedDepth one = warped_depth(depth, pose, 1, view);
  const WarpedDepth three = warped_depth(depth, pose, 3, view);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) EXPECT_EQ(one.w.at(x, y), three.w.at(x, y));
}

TEST(Warp, single_pixels_of_either_camera_do_no_harm) {
  const WarpedDepth tof = warped_depth(Image<float>({1, 1}, 2.0F));
  EXPECT_EQ(tof.w.at(15, 15), 0.0F);
  const WarpedDepth view = warped_depth(Image<float>(kWarpTof, 2.0F), {}, 1, {1, 1});
  EXPECT_NEAR(view.w.at(0, 0), 0.5F, 1e-6F);
}

}  // namespace
}  // namespace mixrig::test
