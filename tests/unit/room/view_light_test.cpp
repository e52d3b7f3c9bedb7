// SPDX-License-Identifier: Apache-2.0
// Plates of known light at several exposures, by a camera whose exposure differs from its setting.
#include "host/room/scan/panorama/view_light.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"

namespace mixrig::model {
namespace {

constexpr Size kPlate{96, 64};
constexpr double kRest_s = 8e-3;

/// Light from 0.01 on the left to 1.2 on the right, and a lamp of 20 in a corner.
double light_at(int x, int y) {
  if (x < 20 && y < 12) return 20;
  return 0.01 * std::pow(120, x / 95.0);
}

/// A sensor of 10,000 electrons.
Image<Rgb8> exposed(double factor, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Image<Rgb8> plate(kPlate);
  for (int y = 0; y < kPlate.height; ++y)
    for (int x = 0; x < kPlate.width; ++x) {
      const auto byte = [&](double share) {
        const double charge = 1e4 * share * factor * light_at(x, y);
        const double noisy = charge + std::sqrt(charge + 64) * normal(random);
        return srgb_byte_from_linear(static_cast<float>(noisy / 1e4));
      };
      plate.at(x, y) = {byte(1), byte(0.9), byte(0.8)};
    }
  return plate;
}

/// A view with plates at these times; each is exposed by `longer_s` more than stated.
ScanView view_with(const std::vector<double>& exposures_s, double longer_s) {
  ScanView view;
  view.plate = exposed(1, 1);
  unsigned seed = 2;
  for (const double s : exposures_s)
    view.brackets.push_back({s / kRest_s, exposed((s + longer_s) / (kRest_s + longer_s), seed++)});
  return view;
}

/// Quantile of the relative error of green where `counts(light)`.
double error_of(const ScanView& view, double q, bool (*counts)(double)) {
  std::vector<double> errors;
  for (int y = 0; y < kPlate.height; ++y)
    for (int x = 0; x < kPlate.width; ++x)
      if (const double is = light_at(x, y); counts(is))
        errors.push_back(std::abs(float_of_half(view.light.at(x, y).g) / (0.9 * is) - 1));
  std::sort(errors.begin(), errors.end());
  return errors[static_cast<std::size_t>(q * static_cast<double>(errors.size() - 1))];
}

bool is_lamp(double light) { return light > 2; }
bool is_surface(double light) { return light > 0.05 && light < 2; }

TEST(ViewLight, ExposuresAreWhatThePicturesShow) {
  const std::vector<ScanView> views{view_with({2e-3, 5e-4, 1.2e-4}, 4e-5)};
  const auto found = find_exposures(views);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].nominal, 1);
  EXPECT_EQ(found[0].measured, 1);
  for (std::size_t i = 1; i < 3; ++i) {
    const double s = found[i].nominal * kRest_s;
    EXPECT_NEAR(found[i].measured / ((s + 4e-5) / (kRest_s + 4e-5)), 1, 0.01) << i;
    EXPECT_GT(found[i].samples, 300U);
    EXPECT_TRUE(found[i].used);
  }
}

TEST(ViewLight, ALampAndSurfacesHaveTheirLight) {
  std::vector<ScanView> views{view_with({2e-3, 5e-4, 2e-4, 3.2e-2}, 9e-6)};
  Crew crew(1);
  join_brackets(find_exposures(views), views, crew);
  ASSERT_FALSE(views[0].light.empty());
  EXPECT_TRUE(views[0].brackets.empty());
  EXPECT_LT(error_of(views[0], 0.5, is_lamp), 0.02);
  EXPECT_LT(error_of(views[0], 0.95, is_lamp), 0.06);
  EXPECT_LT(error_of(views[0], 0.95, is_surface), 0.05);
  EXPECT_GT(views[0].light_limit, 30);
}

TEST(ViewLight, WhatSaturatesInAllPlatesReachesTheLimit) {
  std::vector<ScanView> views{view_with({2e-3}, 0)};
  Crew crew(1);
  join_brackets(find_exposures(views), views, crew);
  EXPECT_GE(float_of_half(views[0].light.at(5, 5).r), views[0].light_limit);
  EXPECT_NEAR(views[0].light_limit, 3.85, 0.1);
  EXPECT_LT(float_of_half(views[0].light.at(90, 40).r), views[0].light_limit);
}

TEST(ViewLight, WhatMovedBetweenThePlatesIsNotJoined) {
  std::vector<ScanView> views{view_with({2e-3}, 0)};
  Image<Rgb8>& shorter = views[0].brackets[0].plate;
  for (int y = 20; y < 50; ++y)
    for (int x = 30; x < 60; ++x) shorter.at(x, y) = {0, 0, 0};  // somebody in black
  Crew crew(1);
  join_brackets(find_exposures(views), views, crew);
  const float linear = linear_of_srgb_bytes()[views[0].plate.at(50, 30).g];
  EXPECT_NEAR(float_of_half(views[0].light.at(50, 30).g) / linear, 1, 0.002);
}

TEST(ViewLight, AnExposureThatTheCameraDidNotTakeIsNotUsed) {
  std::vector<ScanView> views{view_with({2e-3}, 0)};
  views[0].brackets.push_back({5e-4 / kRest_s, views[0].brackets[0].plate});  // as before it
  const auto found = find_exposures(views);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_TRUE(found[1].used);
  EXPECT_FALSE(found[2].used);
  Crew crew(1);
  join_brackets(found, views, crew);
  EXPECT_NEAR(views[0].light_limit, 3.85, 0.1);
}

TEST(ViewLight, WithoutOtherPlatesThereIsNoLight) {
  std::vector<ScanView> views{view_with({}, 0)};
  EXPECT_TRUE(find_exposures(views).empty());
  Crew crew(1);
  join_brackets({}, views, crew);
  EXPECT_TRUE(views[0].light.empty());
}

}  // namespace
}  // namespace mixrig::model
