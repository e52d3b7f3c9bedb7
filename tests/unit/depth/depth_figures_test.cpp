// SPDX-License-Identifier: Apache-2.0
// Pictures of planes that are made here, with errors that are known.
#include "host/capture/depth/depth_figures.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"

namespace mixrig::depth {
namespace {

constexpr Size kSize{256, 192};
const geometry::CameraModel kEye{{kSize, 200, 201, 127, 95}, {}};

Eigen::Vector3d eye_ray(int x, int y) { return {(x - 127) / 200.0, (y - 95) / 201.0, 1}; }

/// A wall 2 m away, met at right angles, moved away by `error_m` of the place on it.
template <typename Error>
Image<float> wall_picture(Error error_m) {
  Image<float> z_m(kSize);
  for (const auto [x, y] : test::each_pixel(kSize))
    z_m.at(x, y) = static_cast<float>(2 + error_m(2 * eye_ray(x, y).x()));
  return z_m;
}

/// Two walls at right angles, 45 degrees to the axis, whose corner is vertical and 3 m away. The
/// pixels whose surface lies less than `reach_m` from the corner are `error_m` too far along the
/// ray.
Image<float> corner_picture(double error_m, double reach_m) {
  Image<float> z_m(kSize);
  for (const auto [x, y] : test::each_pixel(kSize)) {
    const Eigen::Vector3d ray = eye_ray(x, y);
    const double z = 3 / (1 + std::abs(ray.x())), away_m = std::sqrt(2.0) * std::abs(z * ray.x());
    z_m.at(x, y) = static_cast<float>(z + (away_m < reach_m ? error_m / ray.norm() : 0));
  }
  return z_m;
}

DepthFigures figures_of(const Image<float>& z_m) {
  DepthMeter meter(kEye);
  meter.add(z_m, {}, {});
  return meter.figures();
}

TEST(DepthFigures, AFlatWallIsFlatAndABentOneBentByAsMuch) {
  const DepthFigures flat = figures_of(wall_picture([](double) { return 0.0; }));
  ASSERT_EQ(flat.planes.size(), 1U);
  EXPECT_LT(flat.planes[0].rms_m, 1e-5);
  // 256 x 192 pixels, 2 m away.
  EXPECT_NEAR(flat.planes[0].area_m2, 2.56 * 1.92 * 200 / 201, 0.02);
  // a x^2 over -w..w differs from its best line by a w^2 sqrt(4/45) rms; |x| by w sqrt(1/12).
  constexpr double kHalf_m = 1.28, kBend = 0.02;
  const auto bent = figures_of(wall_picture([](double x_m) { return kBend * x_m * x_m; }));
  ASSERT_EQ(bent.planes.size(), 1U);
  EXPECT_NEAR(bent.planes[0].bend_m, kBend * kHalf_m * kHalf_m * std::sqrt(4 / 45.0), 2e-4);
  EXPECT_NEAR(bent.planes[0].rms_m, bent.planes[0].bend_m, 1e-4);
  const auto wavy = figures_of(
      wall_picture([](double x_m) { return 0.01 * std::sin(4 * 3.14159 * x_m / kHalf_m); }));
  ASSERT_EQ(wavy.planes.size(), 1U);
  EXPECT_NEAR(wavy.planes[0].rms_m, 0.01 * std::sqrt(0.5), 5e-4);
  EXPECT_LT(wavy.planes[0].bend_m, 0.003);
}

TEST(DepthFigures, ACornersErrorIsFoundWhereItIs) {
  const auto square = figures_of(corner_picture(0, 0));
  ASSERT_EQ(square.corners.size(), 1U);
  EXPECT_NEAR(square.corners[0].angle_deg, 90, 0.01);
  for (const double e : square.corners[0].error_m) EXPECT_NEAR(e, 0, 1e-4);
  const auto rounded = figures_of(corner_picture(0.04, 0.1));
  ASSERT_EQ(rounded.corners.size(), 1U);
  EXPECT_NEAR(rounded.corners[0].angle_deg, 90, 0.01);
  const std::array<double, kCornerBands> expected_m{0.04, 0.04, 0, 0};
  for (std::size_t i = 0; i < kCornerBands; ++i)
    EXPECT_NEAR(rounded.corners[0].error_m[i], expected_m[i], 1e-4) << i;
}

TEST(DepthFigures, AConvexEdgeIsNoCorner) {
  Image<float> z_m(kSize);
  for (const auto [x, y] : test::each_pixel(kSize))
    z_m.at(x, y) = static_cast<float>(2 / (1 - std::abs(eye_ray(x, y).x())));
  const auto figures = figures_of(z_m);
  EXPECT_EQ(figures.planes.size(), 2U);
  EXPECT_TRUE(figures.corners.empty());
}

TEST(DepthFigures, NoiseIsThatOfAPixelAndAFixedPatternIsSpatialAlone) {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 0.008F), pattern(0, 0.006F);
  const Image<float> wall = wall_picture([](double) { return 0.0; });
  Image<float> fixed(kSize);
  for (const auto [x, y] : test::each_pixel(kSize))
    fixed.at(x, y) = wall.at(x, y) + pattern(random);
  const Image<float> amplitude(kSize, 345.0F);
  DepthMeter meter(kEye);
  Image<float> before = fixed;
  for (int i = 0; i < 6; ++i) {
    Image<float> z_m = fixed;
    for (const auto [x, y] : test::each_pixel(kSize)) z_m.at(x, y) += noise(random);
    if (i > 0) meter.add(before, amplitude, z_m);
    before = z_m;
  }
  const DepthFigures figures = meter.figures();
  ASSERT_EQ(figures.noise.size(), 2U) << "the noise spreads the wall over both sides of 2 m";
  EXPECT_FALSE(figures.moves);
  for (const NoiseRow& row : figures.noise) {
    EXPECT_NEAR(row.spatial_m, 0.010, 0.0012);
    EXPECT_NEAR(row.temporal_m, 0.008, 0.0012);
    EXPECT_EQ(row.amplitude, 345);
  }
  ASSERT_EQ(figures.planes.size(), 5U);
  for (const Flatness& plane : figures.planes) EXPECT_LT(plane.rms_m, 0.0015);
}

TEST(DepthFigures, ACameraThatMovesHasNoTemporalNoise) {
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 0.003F);
  DepthMeter meter(kEye);
  Image<float> z_m = wall_picture([](double) { return 0.0; });
  for (const auto [x, y] : test::each_pixel(kSize)) z_m.at(x, y) += noise(random);
  const Image<float> next = wall_picture([](double) { return 0.1; });
  meter.add(z_m, {}, next);
  const DepthFigures figures = meter.figures();
  EXPECT_TRUE(figures.moves);
  ASSERT_FALSE(figures.noise.empty());
  for (const NoiseRow& row : figures.noise) EXPECT_EQ(row.temporal_m, 0);
}

/// A near and a far half, with `across` in the two columns between them.
DepthFigures step_figures(float first, float second) {
  Image<float> z_m(kSize);
  for (const auto [x, y] : test::each_pixel(kSize))
    z_m.at(x, y) = x < 100 ? 1.5F : x == 100 ? first : x == 101 ? second : 3;
  return figures_of(z_m);
}

TEST(DepthFigures, PixelsBetweenBothSurfacesFlyAndUnknownOnesAreCounted) {
  const DepthFigures sharp = step_figures(3, 3), mixed = step_figures(2, 2.5F),
                     lost = step_figures(0, 3), mirrored = step_figures(1.5F, 2);
  // Each row is one step.
  for (const DepthFigures* f : {&sharp, &mixed, &lost, &mirrored}) EXPECT_EQ(f->steps, 192U);
  EXPECT_EQ(sharp.flying_pixels, 0);
  EXPECT_EQ(mixed.flying_pixels, 2);
  EXPECT_EQ(mirrored.flying_pixels, 1);
  EXPECT_EQ(lost.flying_pixels, 0);
  EXPECT_EQ(lost.unknown_pixels, 1);
  EXPECT_NEAR(lost.unknown_share, 1 / 256.0, 1e-9);
}

TEST(DepthFigures, UnknownPicturesHaveNoFigures) {
  for (const float value : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()}) {
    const DepthFigures figures = figures_of(Image<float>(kSize, value));
    EXPECT_EQ(figures.unknown_share, 1) << value;
    EXPECT_TRUE(figures.planes.empty() && figures.corners.empty() && figures.noise.empty());
  }
  DepthMeter tiny({{{3, 2}, 3, 3, 1, 1}, {}});
  tiny.add(Image<float>({3, 2}, 1.0F), {}, {});
  EXPECT_TRUE(tiny.figures().planes.empty());
}

}  // namespace
}  // namespace mixrig::depth
