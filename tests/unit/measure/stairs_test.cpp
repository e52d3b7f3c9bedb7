// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/stairs.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

constexpr Size kStairsSize{96, 80};
constexpr double kSlope = 0.3;

/// An object below a line of slope kSlope: brightness is share(distance below it, px).
template <typename Share>
Stairs stairs_of(bool turned, Share&& share) {
  const Size size = turned ? Size{kStairsSize.height, kStairsSize.width} : kStairsSize;
  Image<Rgb8> color(size);
  Image<std::uint8_t> labels(size);
  for (int y = 0; y < kStairsSize.height; ++y)
    for (int x = 0; x < kStairsSize.width; ++x) {
      const double down = y - (25 + kSlope * x);
      const int i = turned ? y : x, j = turned ? x : y;
      const auto v = static_cast<std::uint8_t>(std::lround(60 + 120 * share(down)));
      color.at(i, j) = {v, v, v};
      labels.at(i, j) = down > 0 ? kLayerVirtual : 0;
    }
  Stairs sums;
  add_stairs(color, labels, kLayerVirtual, sums);
  return sums;
}

double normal_share(double down, double sigma) {
  return 0.5 * std::erfc(-down / (sigma * std::sqrt(1 + kSlope * kSlope) * std::sqrt(2.0)));
}

TEST(Stairs, a_border_behind_a_lens_is_even_and_as_wide_as_its_blur) {
  for (const bool turned : {false, true})
    for (const double sigma : {0.7, 1.0}) {
      const Stairs stairs =
          stairs_of(turned, [&](double down) { return normal_share(down, sigma); });
      EXPECT_EQ(stairs.off_line_px.count, 6U);
      EXPECT_LT(*stairs.off_line_px.mean(), 0.04) << sigma;
      // Straight between pixels, the ends of the step are read a tenth of a pixel too far out.
      EXPECT_NEAR(*stairs.width_px.mean(), 2.563 * sigma + 0.22, 0.06) << sigma;
    }
}

TEST(Stairs, whole_pixels_are_stairs_of_a_quarter_of_a_pixel) {
  const Stairs stairs = stairs_of(false, [](double down) { return down > 0 ? 1.0 : 0.0; });
  // Evenly spread over half a pixel to either side: 1/4 of a pixel down, by the cosine across.
  EXPECT_NEAR(*stairs.off_line_px.mean(), 0.25 / std::sqrt(1 + kSlope * kSlope), 0.03);
  EXPECT_LT(*stairs.width_px.mean(), 1);
}

TEST(Stairs, more_levels_make_smaller_ones) {
  const auto of_levels = [](int levels) {
    return *stairs_of(false, [=](double down) {
              const double covered = std::min(1.0, std::max(0.0, down + 0.5));
              return std::round(covered * levels) / levels;
            }).off_line_px.mean();
  };
  EXPECT_LT(of_levels(4), 0.6 * of_levels(1));
  EXPECT_LT(of_levels(8), 0.9 * of_levels(4));
}

TEST(Stairs, textures_faint_steps_and_other_layers_are_not_judged) {
  Stairs stairs;
  Image<Rgb8> color(kStairsSize, {90, 90, 90});
  Image<std::uint8_t> labels(kStairsSize);
  for (int y = 40; y < kStairsSize.height; ++y)
    for (int x = 0; x < kStairsSize.width; ++x) {
      labels.at(x, y) = kLayerVirtual;
      color.at(x, y) = {110, 110, 110};
    }
  add_stairs(color, labels, kLayerVirtual, stairs);
  EXPECT_EQ(stairs.width_px.count, 0U) << "20 of 255";
  for (int y = 40; y < kStairsSize.height; ++y)
    for (int x = 0; x < kStairsSize.width; ++x)
      color.at(x, y) = y % 2 ? Rgb8{200, 200, 200} : Rgb8{140, 140, 140};
  add_stairs(color, labels, kLayerVirtual, stairs);
  EXPECT_EQ(stairs.width_px.count, 0U) << "stripes";
  color.fill({90, 90, 90});
  for (int y = 40; y < kStairsSize.height; ++y)
    for (int x = 0; x < kStairsSize.width; ++x) color.at(x, y) = {200, 200, 200};
  add_stairs(color, labels, 1, stairs);
  EXPECT_EQ(stairs.width_px.count, 0U) << "of people";
  add_stairs(color, labels, kLayerVirtual, stairs);
  EXPECT_EQ(stairs.width_px.count, 6U);
}

TEST(Stairs, distance_from_a_line_is_across_it) {
  const std::array<double, 4> zigzag{0, 1, 0, 1}, line{1, 2, 3, 4};
  // The line through 0, 1, 0, 1 has a slope of 1/5: off it by 1/5, 3/5, 3/5, 1/5.
  EXPECT_NEAR(mean_off_line_px(zigzag), 0.4 / std::sqrt(1 + 0.04), 1e-9);
  EXPECT_NEAR(mean_off_line_px(line), 0, 1e-9);
}

}  // namespace
}  // namespace mixrig::measure
