// SPDX-License-Identifier: Apache-2.0
// Depth of field against rays through points of a lens, for planes that hide one another.
#include "host/render/cpu/mix/focus.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "tests/support/count_allocations.h"
#include "tests/support/psnr.h"

namespace mixrig::render::cpu {
namespace {

constexpr Size kLensView{160, 96};
constexpr double kFx_px = 150, kCx_px = 79.5, kCy_px = 47.5, kAperture_m = 0.08;

/// A wall, and before it a board that covers the left half of the view.
struct TwoPlanes {
  double wall_m = 5, board_m = 2;
  float wall_light = 0.6F, board_light = 0.15F;
  double aperture_m = kAperture_m;
  bool stripes = true;

  float light(bool board, double x_m, double y_m) const {
    const double wave = stripes ? std::sin(9 * x_m) * std::sin(7 * y_m) : 0;
    return (board ? board_light : wall_light) * static_cast<float>(1 + 0.5 * wave);
  }
  /// Along a ray from a point of the lens that meets the plane at `focus_m` where the pixel does.
  float seen(double u_px, double v_px, double lens_x_m, double lens_y_m, double focus_m) const {
    const double ray_x = (u_px - kCx_px) / kFx_px, ray_y = (v_px - kCy_px) / kFx_px;
    const auto at = [&](double ray, double lens, double z_m) {
      return lens + (ray - lens / focus_m) * z_m;
    };
    const double board_x = at(ray_x, lens_x_m, board_m);
    if (board_x < 0) return light(true, board_x, at(ray_y, lens_y_m, board_m));
    return light(false, at(ray_x, lens_x_m, wall_m), at(ray_y, lens_y_m, wall_m));
  }
};

Rgb8 grey(float linear) {
  const std::uint8_t v = srgb_byte_from_linear(linear);
  return {v, v, v};
}

/// The sharp picture with its depth.
FrameOutput sharp_picture(const TwoPlanes& scene) {
  FrameOutput out;
  out.color.reset(kLensView), out.mixed_depth_m.reset(kLensView);
  for (int y = 0; y < kLensView.height; ++y)
    for (int x = 0; x < kLensView.width; ++x) {
      out.color.at(x, y) = grey(scene.seen(x, y, 0, 0, 1));
      out.mixed_depth_m.at(x, y) = static_cast<float>(x < kCx_px ? scene.board_m : scene.wall_m);
    }
  return out;
}

constexpr int kBandFrom = 60, kBandTo = 100;  ///< columns about the edge

/// The true picture through the lens as a sum of rays; only the band of columns is drawn.
Image<Rgb8> through_lens(const TwoPlanes& scene, double focus_m) {
  constexpr int kRays = 400;
  Image<Rgb8> out(kLensView);
  for (int y = 0; y < kLensView.height; ++y)
    for (int x = kBandFrom; x < kBandTo; ++x) {
      double sum = 0;
      for (int i = 0; i < kRays; ++i) {
        const double r = 0.5 * scene.aperture_m * std::sqrt((i + 0.5) / kRays), a = 2.399963 * i;
        // The pixel has an area of its own.
        const double du = (i * 7 % kRays + 0.5) / kRays - 0.5,
                     dv = (i * 61 % kRays + 0.5) / kRays - 0.5;
        sum += scene.seen(x + du, y + dv, r * std::cos(a), r * std::sin(a), focus_m);
      }
      out.at(x, y) = grey(static_cast<float>(sum / kRays));
    }
  return out;
}

/// A simple blur: each pixel is the mean of its disc's pixels, whatever their depth.
Image<Rgb8> naive(const FrameOutput& sharp, double focus_m) {
  Image<Rgb8> out(kLensView);
  const auto& linear = linear_of_srgb_bytes();
  for (int y = 0; y < kLensView.height; ++y)
    for (int x = 0; x < kLensView.width; ++x) {
      const double r =
          0.5 * kFx_px * kAperture_m *
          std::abs(1 / static_cast<double>(sharp.mixed_depth_m.at(x, y)) - 1 / focus_m);
      double sum = 0, count = 0;
      const int reach = static_cast<int>(r + 0.5);
      for (int j = std::max(0, y - reach); j <= std::min(kLensView.height - 1, y + reach); ++j)
        for (int i = std::max(0, x - reach); i <= std::min(kLensView.width - 1, x + reach); ++i)
          if (std::hypot(i - x, j - y) <= r) sum += linear[sharp.color.at(i, j).g], ++count;
      out.at(x, y) = count > 0 ? grey(static_cast<float>(sum / count)) : sharp.color.at(x, y);
    }
  return out;
}

Image<Rgb8> part_of(const Image<Rgb8>& picture, int x0, int x1) {
  Image<Rgb8> part(Size{x1 - x0, kLensView.height - 24});
  for (int y = 0; y < part.height(); ++y)
    for (int x = 0; x < part.width(); ++x) part.at(x, y) = picture.at(x0 + x, y + 12);
  return part;
}

FrameOutput focused(const TwoPlanes& scene, double focus_m, bool fast = false) {
  Crew crew(1);
  FocusScratch scratch;
  FrameOutput out = sharp_picture(scene);
  Focus focus;
  focus.distance_m = static_cast<float>(focus_m);
  focus.aperture_m = static_cast<float>(scene.aperture_m);
  focus.most_blur_px = 40;
  focus.fast = fast;
  draw_focus(crew, focus, kFx_px, scratch, out);
  return out;
}

TEST(Focus, IsTheLensOnBothSidesOfAnEdgeAndBetterThanANaiveGather) {
  const TwoPlanes scene;
  for (const double focus_m : {2.0, 5.0, 3.0}) {
    const Image<Rgb8> truth = part_of(through_lens(scene, focus_m), kBandFrom, kBandTo);
    const FrameOutput sharp = sharp_picture(scene);
    const double fine =
        test::psnr_db(part_of(focused(scene, focus_m).color, kBandFrom, kBandTo), truth);
    const double fast =
        test::psnr_db(part_of(focused(scene, focus_m, true).color, kBandFrom, kBandTo), truth);
    const double without = test::psnr_db(part_of(sharp.color, kBandFrom, kBandTo), truth);
    const double plain = test::psnr_db(part_of(naive(sharp, focus_m), kBandFrom, kBandTo), truth);
    std::printf("sharp at %.0f m, band of 40 px: fine %.1f, fast %.1f, naive %.1f, none %.1f dB\n",
                focus_m, fine, fast, plain, without);
    EXPECT_GT(fine, plain + 1);
    EXPECT_GT(fine, without + 1);
    EXPECT_GT(fine, 30);
    EXPECT_GT(fast, 26);
  }
}

/// Discs of up to 23 px; what is compared is 40 px about the edge.
TEST(Focus, WideDiscsAreTheLensToo) {
  TwoPlanes scene;
  scene.aperture_m = 0.51;
  for (const double focus_m : {2.0, 5.0}) {
    const Image<Rgb8> truth = part_of(through_lens(scene, focus_m), kBandFrom, kBandTo);
    const auto psnr_db = [&](const Image<Rgb8>& picture) {
      return test::psnr_db(part_of(picture, kBandFrom, kBandTo), truth);
    };
    const double fine = psnr_db(focused(scene, focus_m).color);
    const double fast = psnr_db(focused(scene, focus_m, true).color);
    const double without = psnr_db(sharp_picture(scene).color);
    std::printf("wide discs, sharp at %.0f m: fine %.1f, fast %.1f, none %.1f dB\n", focus_m, fine,
                fast, without);
    EXPECT_GT(fine, without + 3);
    EXPECT_GT(fine, 28);
    EXPECT_GT(fast, fine - 3);
  }
}

/// A slope without a step is drawn by runs: as by the mean of each pixel's own disc.
TEST(Focus, ASlopeIsBlurredByEachPixelsOwnDisc) {
  FrameOutput out;
  out.color.reset(kLensView), out.mixed_depth_m.reset(kLensView);
  for (int y = 0; y < kLensView.height; ++y)
    for (int x = 0; x < kLensView.width; ++x) {
      out.color.at(x, y) =
          grey(static_cast<float>(0.4 + 0.3 * std::sin(0.5 * x) * std::cos(0.4 * y)));
      out.mixed_depth_m.at(x, y) = static_cast<float>(1 / (0.2 + 0.0015 * x + 0.001 * y));
    }
  const FrameOutput sharp = out;
  Crew crew(1);
  FocusScratch scratch;
  Focus focus;
  focus.distance_m = 5, focus.aperture_m = 0.4F, focus.most_blur_px = 40;
  draw_focus(crew, focus, kFx_px, scratch, out);
  const auto& linear = linear_of_srgb_bytes();
  int worst = 0;
  for (int y = 14; y < kLensView.height - 14; y += 3)
    for (int x = 14; x < kLensView.width - 14; x += 3) {
      const double r = 0.5 * kFx_px * 0.4 * std::abs(1 / sharp.mixed_depth_m.at(x, y) - 0.2);
      double sum = 0, count = 0;
      for (int j = -13; j <= 13; ++j)
        for (int i = -13; i <= 13; ++i) {
          const double part = std::clamp(r + 0.5 - std::hypot(i, j), 0.0, 1.0);
          sum += part * linear[sharp.color.at(x + i, y + j).g], count += part;
        }
      const int expected =
          r < 0.6 ? sharp.color.at(x, y).g : grey(static_cast<float>(sum / count)).g;
      worst = std::max(worst, std::abs(expected - out.color.at(x, y).g));
    }
  EXPECT_LE(worst, 2) << "radii lie between those of the table";
}

TEST(Focus, TheFastRungIsCloseToTheFineOneWhereDiscsAreWide) {
  const TwoPlanes scene;
  Crew crew(1);
  std::array<FrameOutput, 2> out{sharp_picture(scene), sharp_picture(scene)};
  Focus focus;
  focus.distance_m = 1, focus.aperture_m = 0.25F, focus.most_blur_px = 30;
  for (const bool fast : {false, true}) {
    FocusScratch scratch;
    focus.fast = fast;
    draw_focus(crew, focus, kFx_px, scratch, out[fast]);
  }
  const double apart = test::psnr_db(out[0].color, out[1].color);
  EXPECT_GT(apart, 35);
  EXPECT_LT(apart, 100) << "fewer taps are taken";
}

TEST(Focus, ASharpEdgeStaysSharpBeforeABlurredRoom) {
  TwoPlanes scene;
  scene.stripes = false;
  const FrameOutput out = focused(scene, 2);
  for (int x = 40; x < 120; ++x) {
    const int expected = grey(x < kCx_px ? scene.board_light : scene.wall_light).g;
    EXPECT_NEAR(out.color.at(x, 48).g, expected, 1) << x;
  }
}

TEST(Focus, ABlurredEdgeSpreadsOverASharpRoom) {
  TwoPlanes scene;
  scene.stripes = false;
  const FrameOutput out = focused(scene, 5);
  // The disc of the board: 150 px * 0.08 m * (1/2 - 1/5) = 3.6 px wide.
  const auto light = [&](int x) { return linear_of_srgb_bytes()[out.color.at(x, 48).g]; };
  const float middle = 0.5F * (light(79) + light(80));
  EXPECT_NEAR(middle, 0.5F * (scene.board_light + scene.wall_light), 0.05);
  EXPECT_LT(light(78), light(79));
  EXPECT_LT(light(80), scene.wall_light - 0.02F) << "outside the silhouette";
  EXPECT_NEAR(light(84), scene.wall_light, 0.01);
  EXPECT_NEAR(light(75), scene.board_light, 0.01);
}

TEST(Focus, WhatIsSharpIsLeftAsItIs) {
  TwoPlanes scene;
  scene.wall_m = scene.board_m = 3;
  const FrameOutput sharp = sharp_picture(scene), out = focused(scene, 3);
  EXPECT_EQ(test::psnr_db(sharp.color, out.color), 100);
}

TEST(Focus, APointIsADiscWithAllItsLight) {
  Crew crew(1);
  FocusScratch scratch;
  FrameOutput out;
  out.color.reset(kLensView), out.mixed_depth_m.reset(kLensView);
  out.color.fill({});
  out.mixed_depth_m.fill(5);
  out.color.at(80, 48) = {255, 255, 255};
  Focus focus;
  focus.distance_m = 2, focus.aperture_m = 0.4F, focus.most_blur_px = 40;
  draw_focus(crew, focus, kFx_px, scratch, out);  // 150 * 0.4 * 0.3 = 18 px wide
  double sum = 0, squares = 0;
  for (int y = 0; y < kLensView.height; ++y)
    for (int x = 0; x < kLensView.width; ++x) {
      const double light = linear_of_srgb_bytes()[out.color.at(x, y).g];
      sum += light;
      squares += light * ((x - 80) * (x - 80) + (y - 48) * (y - 48));
    }
  EXPECT_NEAR(sum, 1, 0.05);
  EXPECT_NEAR(std::sqrt(2 * squares / sum), 9, 0.4) << "radius of an even disc";
}

TEST(Focus, FollowsAPixelAndHoldsWhereItsDepthIsNotKnown) {
  const TwoPlanes scene;
  Crew crew(1);
  FocusScratch scratch;
  Focus focus;
  focus.pixel = glm::ivec2(30, 48);
  focus.aperture_m = static_cast<float>(kAperture_m), focus.most_blur_px = 40;
  FrameOutput out = sharp_picture(scene);
  draw_focus(crew, focus, kFx_px, scratch, out);
  EXPECT_EQ(test::psnr_db(out.color, focused(scene, 2).color), 100);
  FrameOutput dark = sharp_picture(scene);
  for (int y = 40; y < 56; ++y)
    for (int x = 20; x < 40; ++x) dark.mixed_depth_m.at(x, y) = 0;
  draw_focus(crew, focus, kFx_px, scratch, dark);
  EXPECT_FLOAT_EQ(scratch.focus_w, 0.5F);
}

TEST(Focus, TheSecondFrameAllocatesNothing) {
  const TwoPlanes scene;
  Crew crew(1);
  FocusScratch scratch;
  FrameOutput out = sharp_picture(scene);
  Focus focus;
  focus.distance_m = 2, focus.aperture_m = 0.08F, focus.most_blur_px = 20;
  draw_focus(crew, focus, kFx_px, scratch, out);
  const long before = test::allocations;
  draw_focus(crew, focus, kFx_px, scratch, out);
  EXPECT_EQ(test::allocations, before);
}

}  // namespace
}  // namespace mixrig::render::cpu
