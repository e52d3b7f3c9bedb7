// SPDX-License-Identifier: Apache-2.0
// Light from a bracket of exposures, against light by formula.
#include "host/room/lamps/bracket.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Rgb8 shot_of(double light) {
  const auto v = static_cast<std::uint8_t>(
      std::lround(255 * srgb_from_linear(std::min(1.0, std::max(0.0, light)))));
  return {v, v, v};
}

/// A row of 64 pixels whose light doubles every fourth one, from 0.05 on.
double true_light(int x) { return 0.05 * std::exp2(x / 4.0); }

std::vector<Image<Rgb8>> shots_of(const std::vector<double>& exposures) {
  std::vector<Image<Rgb8>> pictures;
  for (const double exposure : exposures) {
    Image<Rgb8> picture({64, 1});
    for (int x = 0; x < 64; ++x) picture.at(x, 0) = shot_of(exposure * true_light(x));
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

TEST(Bracket, HasTheLightOfTheLongestShotThatIsNotSaturated) {
  const std::vector<double> exposures{1.0 / 64, 1, 1.0 / 4096, 1.0 / 512, 1.0 / 8};
  const auto pictures = shots_of(exposures);
  std::vector<BracketShot> shots;
  for (std::size_t i = 0; i < pictures.size(); ++i) shots.push_back({pictures[i], exposures[i]});
  const BracketLight light = light_of_bracket(shots);
  for (int x = 0; x < 64; ++x) {
    EXPECT_NEAR(light.luminance.at(x, 0) / true_light(x), 1, 0.03) << x;
    EXPECT_EQ(light.saturated.at(x, 0), 0) << x;
  }
}

TEST(Bracket, SaysWhatIsTooBrightForAllShots) {
  const auto pictures = shots_of({1, 1.0 / 8});
  const BracketLight light =
      light_of_bracket(std::vector<BracketShot>{{pictures[0], 1}, {pictures[1], 1.0 / 8}});
  for (int x = 0; x < 64; ++x) {
    const bool too_bright = light.saturated.at(x, 0) != 0;
    EXPECT_EQ(too_bright, true_light(x) > 7.7) << x;  // 250 of 255 is 0.956 of white
    EXPECT_LE(light.luminance.at(x, 0), 1.03 * true_light(x)) << x;
  }
  EXPECT_TRUE(light_of_bracket({}).luminance.empty());
}

TEST(Bracket, ARegionHasTheMeanOverItsSolidAngle) {
  const auto pictures = shots_of({1, 1.0 / 64, 1.0 / 4096});
  const BracketLight light = light_of_bracket(std::vector<BracketShot>{
      {pictures[0], 1}, {pictures[1], 1.0 / 64}, {pictures[2], 1.0 / 4096}});
  BrightRegion region;
  for (const int x : {30, 31, 32}) region.rays.push_back({Vector3d(x, 0, 1), x == 31 ? 2.0 : 1.0});
  region.rays.push_back({Vector3d(90, 0, 1), 5});  // outside the picture
  const auto pixel = [](const Vector3d& ray) { return std::optional(Vector2d(ray.x(), ray.y())); };
  const RegionLight seen = light_of_region(light, region, pixel);
  EXPECT_NEAR(seen.radiance / ((true_light(30) + 2 * true_light(31) + true_light(32)) / 4), 1,
              0.02);
  EXPECT_EQ(seen.saturated_share, 0);
  EXPECT_EQ(light_of_region(light, {}, pixel).radiance, 0);
}

}  // namespace
}  // namespace mixrig::lights
