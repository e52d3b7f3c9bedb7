// SPDX-License-Identifier: Apache-2.0
// The pass `correct` of the back end under test, on depth pictures made by hand.
#include <cmath>
#include <limits>
#include <random>

#include "tests/unit/render/back_end.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kCorrectSize{16, 12};
constexpr int kRight = 1, kDown = 2, kDownRight = 4, kDownLeft = 8;

/// Corrected depth of a camera without distortion and with 100 px focal length.
struct Corrected {
  explicit Corrected(const Image<float>& depth_m, const render::CorrectParams& params = {}) {
    render::Tables tables = render::make_tables(plain_setup({8, 8}, 8, depth_m.size(), 100));
    tables.correct = params;
    corrected = correct_depth(tables, depth_m);
  }
  float z(int x, int y) const { return corrected.z_m.at(x, y); }
  int links(int x, int y) const { return corrected.links.at(x, y); }
  CorrectedDepth corrected;
};

TEST(Correct, bad_values_are_unknown_but_for_those_beside_three_samples) {
  const float bad[] = {0,
                       -1,
                       std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(),
                       2e4F};
  for (const float value : bad) {
    const Corrected c(
        make_image<float>(kCorrectSize, [&](int x, int) { return x < 8 ? 2.0F : value; }));
    for (int y = 0; y < kCorrectSize.height; ++y)
      for (int x = 0; x < kCorrectSize.width; ++x) {
        const bool beside = x == 8 && y > 0 && y < kCorrectSize.height - 1;
        EXPECT_EQ(c.z(x, y), x < 8 || beside ? 2.0F : 0.0F) << value;
      }
  }
}

TEST(Correct, distance_along_the_ray_becomes_z) {
  render::CorrectParams params;
  params.depth_is_distance = true;
  const Corrected c(make_image<float>(kCorrectSize,
                                      [](int x, int y) {
                                        const double u = (x - 7.5) / 100, v = (y - 5.5) / 100;
                                        return static_cast<float>(3 * std::sqrt(1 + u * u + v * v));
                                      }),
                    params);
  for (int y = 0; y < kCorrectSize.height; ++y)
    for (int x = 0; x < kCorrectSize.width; ++x) EXPECT_NEAR(c.z(x, y), 3, 1e-5);
}

TEST(Correct, floor_that_grazes_the_view_stays_whole) {
  // A floor 0.6 m below the camera: rows 4 m away lie 0.27 m apart.
  const auto floor = [](int, int y) { return 60.0F / (static_cast<float>(y) + 9.5F); };
  const Corrected c(make_image<float>({16, 40}, floor));
  for (int y = 2; y < 37; ++y)
    for (int x = 2; x < 13; ++x) {
      EXPECT_TRUE(c.links(x, y) & kDown) << x << "," << y;
      EXPECT_TRUE(c.links(x, y) & kRight) << x << "," << y;
      EXPECT_NEAR(c.z(x, y), floor(x, y), 0.02F * floor(x, y));
    }
}

TEST(Correct, silhouette_is_cut_and_keeps_both_depths) {
  const Corrected c(
      make_image<float>(kCorrectSize, [](int x, int) { return x < 8 ? 1.5F : 3.0F; }));
  for (int y = 0; y < kCorrectSize.height; ++y) {
    EXPECT_FALSE(c.links(7, y) & kRight);
    EXPECT_FLOAT_EQ(c.z(7, y), 1.5F);
    EXPECT_FLOAT_EQ(c.z(8, y), 3.0F);
  }
  EXPECT_EQ(c.links(4, 4), kRight + kDown + kDownRight + kDownLeft);
  EXPECT_EQ(c.links(7, 4), kDown + kDownLeft);
  EXPECT_EQ(c.links(8, 4), kRight + kDown + kDownRight);
  EXPECT_EQ(c.links(15, 4), kDown + kDownLeft) << "the picture ends";
  EXPECT_EQ(c.links(4, 11), kRight);
}

TEST(Correct, where_the_lens_has_no_ray_depth_is_unknown) {
  render::Tables tables = render::make_tables(plain_setup({8, 8}, 8, kCorrectSize, 100));
  tables.tof_ray.reset(kCorrectSize, glm::vec2(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(correct_depth(tables, Image<float>(kCorrectSize, 2.0F)).z_m.at(3, 2), 0);
}

TEST(Correct, a_sample_between_two_surfaces_is_no_plane) {
  render::CorrectParams params;
  params.step_min_m = 0.2F;
  const Corrected c(make_image<float>(kCorrectSize,
                                      [](int x, int) {
                                        return x < 8 ? 3.5F : x == 8 ? 3.65F : 3.9F;
                                      }),
                    params);
  EXPECT_TRUE(c.links(7, 5) & kRight) << "within a step";
  EXPECT_FALSE(c.links(8, 5) & kRight) << "in line with the near surface, not with the far one";
}

TEST(Correct, flying_pixel_goes_to_the_surface_that_fills_most_of_it) {
  // Amplitudes fall with z^2, so the near surface at 1.5 m pulls four times as hard as that at 3 m:
  // at half of the pixel, the mean lies at (4 * 1.5 + 3) / 5 = 1.8 m.
  const auto with = [](float flying) {
    return Corrected(make_image<float>(kCorrectSize, [&](int x, int) {
      return x < 8 ? 1.5F : x == 8 ? flying : 3.0F;
    }));
  };
  EXPECT_FLOAT_EQ(with(1.75F).z(8, 6), 1.5F);
  EXPECT_FLOAT_EQ(with(1.85F).z(8, 6), 3.0F);
}

TEST(Correct, lonely_pixel_and_hole_of_one_pixel_take_the_median) {
  for (const float odd : {0.3F, 0.0F, 6.0F}) {
    const Corrected c(make_image<float>(
        kCorrectSize, [&](int x, int y) { return x == 5 && y == 5 ? odd : 2.0F; }));
    EXPECT_FLOAT_EQ(c.z(5, 5), 2.0F) << odd;
  }
}

TEST(Correct, median_of_eight_is_the_fifth_in_ascending_order) {
  const auto filled = [](int near_in_column) {  // neighbours in the column of the hole, 1 or 2
    return Corrected(make_image<float>(kCorrectSize,
                                       [&](int x, int y) {
                                         if (x == 5 && y == 5) return 0.0F;
                                         const bool is_near =
                                             x < 5 || (x == 5 && y < 5 + 6 * (near_in_column - 1));
                                         return is_near ? 2.0F : 4.0F;
                                       }))
        .z(5, 5);
  };
  EXPECT_FLOAT_EQ(filled(2), 2.0F) << "five are near";
  EXPECT_FLOAT_EQ(filled(1), 4.0F) << "four are near";
}

TEST(Correct, hole_beside_three_samples_is_filled_and_beside_two_stays) {
  const Corrected c(make_image<float>(kCorrectSize, [](int x, int y) {
    return (x == 4 && y == 4) || (x == 5 && y == 4) || (x == 4 && y == 5) ? 2.0F : 0.0F;
  }));
  EXPECT_FLOAT_EQ(c.z(5, 5), 2.0F);
  EXPECT_FLOAT_EQ(c.z(5, 3), 0.0F);
  EXPECT_FLOAT_EQ(c.z(6, 4), 0.0F);
}

TEST(Correct, line_of_single_pixels_survives) {
  const Corrected c(
      make_image<float>(kCorrectSize, [](int x, int) { return x == 6 ? 2.0F : 4.0F; }));
  for (int y = 1; y < kCorrectSize.height - 1; ++y) EXPECT_FLOAT_EQ(c.z(6, y), 2.0F);
}

TEST(Correct, noise_of_a_wall_shrinks_and_cuts_nothing) {
  std::mt19937 random(1);
  // Far above the declared noise of 10 mm: a dark wall.
  std::normal_distribution<float> noise(3.0F, 0.05F);
  const Size size{64, 64};
  const Corrected c(make_image<float>(size, [&](int, int) { return noise(random); }));
  double square = 0;
  int cut = 0, n = 0;
  for (int y = 4; y < 60; ++y)
    for (int x = 4; x < 60; ++x) {
      square += (c.z(x, y) - 3.0) * (c.z(x, y) - 3.0);
      cut += (c.links(x, y) & 15) != 15;
      ++n;
    }
  EXPECT_LT(std::sqrt(square / n), 0.05 / 2.2);
  EXPECT_LT(cut, n / 100);
}

/// A wall 4 m away, seen by 365 px of focal length, with what lies at `near_m` before it.
template <typename IsNear>
Corrected wall_with(float near_m, const IsNear& is_near) {
  render::CorrectParams params;
  params.stray_px_m2 = render::kStrayAreaM2 * 365 * 365;
  return Corrected(
      make_image<float>({64, 64}, [&](int x, int y) { return is_near(x, y) ? near_m : 4.0F; }),
      params);
}
int near_px(const Corrected& c) {
  int count = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) count += c.z(x, y) > 0 && c.z(x, y) < 3.5F;
  return count;
}

TEST(Correct, piece_a_period_too_near_is_dropped) {
  // A Kinect v2 shows the border of a moving leg like this: 2x10 pixels at 4 m less 1.87 m.
  const auto is_near = [](int x, int y) { return x >= 30 && x < 32 && y >= 25 && y < 35; };
  EXPECT_EQ(near_px(wall_with(2.13F, is_near)), 0);
}

TEST(Correct, two_such_pieces_beside_each_other_are_both_dropped) {
  const auto is_near = [](int x, int y) {
    return (x >= 26 && x < 28 && y >= 25 && y < 35) || (x >= 36 && x < 39 && y >= 26 && y < 30);
  };
  EXPECT_EQ(near_px(wall_with(2.13F, is_near)), 0);
}

TEST(Correct, things_stay_that_are_large_long_or_not_far_before_the_wall) {
  const auto hand = [](int x, int y) { return x >= 26 && x < 38 && y >= 26 && y < 38; };
  EXPECT_EQ(near_px(wall_with(2.13F, hand)), 144) << "12x12 pixels at 2.13 m are 7x7 cm";
  const auto pole = [](int x, int) { return x == 31 || x == 32; };
  EXPECT_GE(near_px(wall_with(2.13F, pole)), 2 * 60);
  const auto pole_end = [](int x, int y) { return (x == 31 || x == 32) && y > 20; };
  EXPECT_GE(near_px(wall_with(2.13F, pole_end)), 2 * 42);
  const auto slanting = [](int x, int y) {
    return std::abs(2 * (x - 32) - (y - 20)) < 4 && y > 20;
  };
  const Corrected slants = wall_with(2.13F, slanting);
  EXPECT_GT(slants.z(33, 22), 0) << "the end of a stick";
  EXPECT_LT(slants.z(33, 22), 3);
  const auto small = [](int x, int y) { return x >= 30 && x < 33 && y >= 30 && y < 33; };
  EXPECT_GT(near_px(wall_with(3.4F, small)), 0) << "a surface 0.6 m before the wall";
}

TEST(Correct, picture_of_one_pixel_has_no_links) {
  const Corrected c(Image<float>({1, 1}, 2.0F));
  EXPECT_EQ(c.links(0, 0), 0);
}

}  // namespace
}  // namespace mixrig::test
