// SPDX-License-Identifier: Apache-2.0
// Changes of lamps are separated from changes of the camera's exposure, in a room drawn by formula.
#include "host/room/lamps/light_change.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::test {
namespace {

using lights::WatchedPlace;

constexpr double kNow = 1.6;  // the camera's gain

/// A floor of 6 x 6 m and a wall under three lamps at 3 m, with ambient light.
std::vector<WatchedPlace> places_under(const Eigen::Vector4d& factor, double outliers) {
  const Eigen::Vector3d lamps[] = {{1, 1, 3}, {5, 1, 3}, {3, 5, 3}};
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0, 0.02);
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<WatchedPlace> places;
  for (int i = 0; i < 1500; ++i) {
    const bool wall = i % 3 == 0;
    const Eigen::Vector3d at(wall ? 0 : 6 * any(random), 6 * any(random),
                             wall ? 2 * any(random) : 0);
    const Eigen::Vector3d normal = wall ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
    WatchedPlace place{Eigen::Vector4d(0.1, 0, 0, 0), 0};
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d to = lamps[k] - at;
      place.share[k + 1] = std::max(0.0, normal.dot(to)) * to.z() / std::pow(to.squaredNorm(), 2);
    }
    place.share /= place.share.sum();
    place.ratio = kNow * place.share.dot(factor) * (1 + noise(random));
    if (any(random) < outliers) place.ratio = 3 * any(random);
    place.surface = (wall ? 100 : 0) + 10 * static_cast<int>(at.x()) + static_cast<int>(at.y());
    places.push_back(place);
  }
  return places;
}

TEST(LightChange, a_lamp_that_is_dimmed_is_told_from_exposure) {
  const Eigen::Vector4d factor(1, 1, 0.3, 1);
  const auto change = lights::fit_light_change(places_under(factor, 0.25));
  ASSERT_TRUE(change);
  EXPECT_NEAR(change->gain, kNow, 0.03);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(change->shown[k] / kNow, factor[k], 0.06) << k;
    EXPECT_LE(std::abs(change->shown[k] - kNow * factor[k]), 5 * change->sigma[k] + 0.01) << k;
  }
  EXPECT_GT(change->places_weight, 0.6);
}

TEST(LightChange, a_lamp_that_is_dimmed_shows_wherever_it_gives_light) {
  const auto change = lights::fit_light_change(places_under({1, 1, 0.3, 1}, 0.25));
  ASSERT_TRUE(change);
  EXPECT_GT(change->agreed[2], 0.9);
  EXPECT_GT(change->surfaces[2], 10);
}

/// People under a lamp whom nobody sees: half of the floor there loses its light, the rest does
/// not.
TEST(LightChange, a_shadow_shows_on_few_surfaces) {
  auto places = places_under(Eigen::Vector4d::Ones(), 0.05);
  for (WatchedPlace& place : places) {
    const int x = place.surface / 10 % 10, y = place.surface % 10;
    if (place.surface < 100 && x >= 4 && y < 2) place.ratio -= 0.6 * kNow * place.share[2];
  }
  const auto change = lights::fit_light_change(places);
  ASSERT_TRUE(change);
  EXPECT_LT(change->agreed[2], 0.6);
}

TEST(LightChange, exposure_alone_changes_no_lamp) {
  const auto change = lights::fit_light_change(places_under(Eigen::Vector4d::Ones(), 0.25));
  ASSERT_TRUE(change);
  EXPECT_NEAR(change->gain, kNow, 0.02);
  EXPECT_GT(change->gain_weight, 0.99);
}

TEST(LightChange, a_lamp_that_is_off_is_not_negative) {
  const auto change = lights::fit_light_change(places_under({1, 0, 1, 1}, 0.1));
  ASSERT_TRUE(change);
  EXPECT_GE(change->shown.minCoeff(), 0);
  EXPECT_NEAR(change->shown[1], 0, 0.03);
  EXPECT_NEAR(change->gain, kNow, 0.03);
}

TEST(LightChange, chaos_is_not_explained_and_few_places_tell_nothing) {
  auto places = places_under(Eigen::Vector4d::Ones(), 1);
  const auto change = lights::fit_light_change(places);
  const auto calm = lights::fit_light_change(places_under(Eigen::Vector4d::Ones(), 0));
  ASSERT_TRUE(change && calm);
  EXPECT_GT(change->sigma.maxCoeff(), 5 * calm->sigma.maxCoeff());
  places.resize(50);
  EXPECT_FALSE(lights::fit_light_change(places));
}

}  // namespace
}  // namespace mixrig::test
