// SPDX-License-Identifier: Apache-2.0
// The image circle in pictures drawn by formula.
#include "host/calibrate/board/image_circle.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::calibration {
namespace {

using Eigen::Vector2d;

constexpr Size kPicture{320, 240};

/// Light of a scene, 0..1, at a pixel of one of several pictures.
using BoardScene = std::function<double(double x, double y, int picture)>;

/// A room whose furniture lies elsewhere in every picture; a third of each picture is dark.
double furnished(double x, double y, int picture) {
  const double wave = std::sin(0.045 * x + 1.9 * picture) * std::cos(0.05 * y - 1.3 * picture);
  return wave < -0.25 ? 0.02 : 0.35 + 0.4 * std::abs(wave);
}

struct Look {
  Vector2d center_px{160, 120};
  double radius_px = 1e4;    ///< beyond the picture: it is filled
  double softness_px = 1.5;  ///< sigma of the rim
  double black = 9, noise = 2;
  double flare = 0;  ///< grey levels outside the circle, more to the left
};

std::uint8_t grey(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

BrightestPicture draw(const Look& look, const BoardScene& scene, int pictures = 6) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, look.noise);
  BrightestPicture brightest;
  for (int i = 0; i < pictures; ++i) {
    Image<std::uint8_t> picture(kPicture);
    for (int y = 0; y < kPicture.height; ++y)
      for (int x = 0; x < kPicture.width; ++x) {
        const double off = (Vector2d(x, y) - look.center_px).norm() - look.radius_px;
        const double open = 0.5 * std::erfc(off / (std::sqrt(2.0) * look.softness_px));
        picture.at(x, y) = grey(look.black + 240 * open * scene(x, y, i) +
                                look.flare * (1 - open) * (1 - x / 320.0) + noise(random));
      }
    brightest.add(picture.view());
  }
  return brightest;
}

void expect_circle(const char* name, const Look& look, double tolerance_px) {
  const auto found = find_image_circle(draw(look, furnished).image());
  ASSERT_TRUE(found) << name;
  EXPECT_LT((found->center_px - look.center_px).norm(), tolerance_px) << name;
  EXPECT_NEAR(found->radius_px, look.radius_px, tolerance_px) << name;
  EXPECT_GT(found->seen, 0.8) << name;
  EXPECT_LT(found->residual_px, 1) << name;
}

TEST(ImageCircle, IsFoundWhereLightEndsOnOne) {
  expect_circle("inside the picture", {.center_px = {158.3, 121.6}, .radius_px = 110}, 0.3);
  expect_circle("off-centre", {.center_px = {125, 100}, .radius_px = 85}, 0.3);
  expect_circle("cut by top and bottom", {.center_px = {163, 118}, .radius_px = 140}, 0.5);
  expect_circle("cut by one side", {.center_px = {90, 120}, .radius_px = 105}, 0.5);
  expect_circle("all sides but the corners", {.center_px = {160, 120}, .radius_px = 175}, 1);
  expect_circle("noise", {.center_px = {160, 120}, .radius_px = 110, .noise = 10}, 0.5);
  expect_circle("soft", {.center_px = {160, 120}, .radius_px = 110, .softness_px = 4}, 0.8);
  expect_circle("stray light", {.center_px = {160, 120}, .radius_px = 110, .flare = 40}, 0.5);
}

TEST(ImageCircle, IsFoundWherePartOfTheRimIsDark) {
  // Nothing is lit in a quarter of the picture, in any of the pictures.
  const Look look{.center_px = {160, 120}, .radius_px = 108};
  const auto found = find_image_circle(draw(look, [](double x, double y, int picture) {
                                         return x > 160 && y > 120 ? 0.0 : furnished(x, y, picture);
                                       }).image());
  ASSERT_TRUE(found);
  EXPECT_LT((found->center_px - look.center_px).norm(), 0.5);
  EXPECT_NEAR(found->radius_px, look.radius_px, 0.5);
  EXPECT_NEAR(found->seen, 0.75, 0.1);
}

TEST(ImageCircle, ThereIsNoneWithoutARim) {
  const auto none = [](const char* name, const BoardScene& scene, const Look& look = {}) {
    const auto found = find_image_circle(draw(look, scene).image());
    EXPECT_FALSE(found) << name << ": radius " << (found ? found->radius_px : 0);
  };
  none("a filled picture", furnished);
  none("black", [](double, double, int) { return 0; });
  none("black and noise", [](double, double, int) { return 0; }, {.noise = 12});
  none("dim", [](double, double, int) { return 0.04; },
       {.center_px = {160, 120}, .radius_px = 110});
  none("a lens with vignetting", [](double x, double y, int) {
    const double r2 = (Vector2d(x, y) - Vector2d(160, 120)).squaredNorm() / (160.0 * 160.0);
    return 0.9 / std::pow(1 + r2, 2);
  });
  none("dark above, lit below", [](double, double y, int) { return y > 120 ? 0.7 : 0.0; });
  none("one corner is dark", [](double x, double y, int) { return x + y < 140 ? 0.0 : 0.7; });
  none("a dark room with a window",
       [](double x, double y, int) { return x > 100 && x < 230 && y > 50 && y < 200 ? 0.8 : 0.0; });
  none("a dark room with lamps, which move", [](double x, double y, int picture) {
    double light = 0.01;
    for (int lamp = 0; lamp < 4; ++lamp) {
      const Vector2d at(60 + 55 * lamp + 9 * picture, 60 + 40 * ((lamp + picture) % 3));
      light += std::exp(-(Vector2d(x, y) - at).squaredNorm() / 450);
    }
    return std::min(light, 1.0);
  });
  none("a soft pool of light", [](double x, double y, int) {
    const double r = (Vector2d(x, y) - Vector2d(160, 120)).norm();
    return 0.5 * std::erfc((r - 80) / 25);
  });
  none("half of the rim is dark",
       [](double x, double y, int i) { return x > 150 ? 0.0 : furnished(x, y, i); },
       {.center_px = {160, 120}, .radius_px = 108});
}

TEST(ImageCircle, TakesAnyPicture) {
  EXPECT_FALSE(find_image_circle({}));
  for (const Size size : {Size{1, 1}, Size{3, 200}, Size{40, 40}, Size{41, 500}})
    for (const int value : {0, 9, 255}) {
      const Image<std::uint8_t> flat(size, static_cast<std::uint8_t>(value));
      EXPECT_FALSE(find_image_circle(flat.view()));
    }
  std::mt19937 random(3);
  Image<std::uint8_t> noise(kPicture);
  for (int y = 0; y < kPicture.height; ++y)
    for (int x = 0; x < kPicture.width; ++x) noise.at(x, y) = static_cast<std::uint8_t>(random());
  EXPECT_FALSE(find_image_circle(noise.view()));
  BrightestPicture brightest;
  EXPECT_TRUE(brightest.image().empty());
  brightest.add(noise.view());
  brightest.add(Image<std::uint8_t>({10, 10}, 255).view());  // of another size: left out
  EXPECT_EQ(brightest.image().at(5, 5), noise.at(5, 5));
}

}  // namespace
}  // namespace mixrig::calibration
