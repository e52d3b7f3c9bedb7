// SPDX-License-Identifier: Apache-2.0
// Reconstructions of random places against the poses that made their tracks.
#include "extras/map/reconstruction/growth/reconstruct.h"

#include <gtest/gtest.h>

#include "host/math/estimation/points/rigid_fit.h"
#include "tests/unit/map/moving_rays.h"

namespace mixrig {
namespace {

/// Root mean square distance of the places of the path from the true ones, share of its extent.
double error_share(const reconstruction::LearnedMap& map, const test::MovingRays& scene) {
  std::vector<Eigen::Vector3d> found, truth;
  for (const auto& pose : map.path) {
    found.push_back(pose.world_from_body.translation_m);
    truth.push_back(
        scene.world_from_camera(static_cast<int>(std::lround(10 * pose.t_s))).translation_m);
  }
  const auto fit = estimation::similarity_fit(found, truth);
  if (!fit.usable()) return 1;
  const double extent = (truth.back() - truth.front()).norm();
  return std::sqrt(fit.residuals.squaredNorm() / static_cast<double>(truth.size())) / extent;
}

TEST(Reconstruct, PathIsTheTrueOne) {
  const test::MovingRays scene;
  const auto camera = test::wide_camera();
  const auto map = reconstruction::reconstruct(scene.tracks(camera), camera);
  ASSERT_TRUE(map) << map.error().context;
  EXPECT_EQ(map->path.size(), 12U);
  EXPECT_LT(error_share(*map, scene), 0.003);
  EXPECT_NEAR(reconstruction::extent_of(map->path), 1, 1e-9);
  EXPECT_FALSE(map->scale);
  EXPECT_LT(map->residual_px, 0.25);
}

TEST(Reconstruct, FortyPercentWrongTracksAreLeftOut) {
  test::MovingRays scene;
  scene.wrong_share = 0.4;
  const auto camera = test::wide_camera();
  const auto map = reconstruction::reconstruct(scene.tracks(camera), camera);
  ASSERT_TRUE(map) << map.error().context;
  EXPECT_LT(error_share(*map, scene), 0.006);
  EXPECT_LT(map->points.size(), 160U);
}

TEST(Reconstruct, AWallAloneIsEnough) {
  test::MovingRays scene;
  scene.flat = true;
  const auto camera = test::wide_camera();
  const auto map = reconstruction::reconstruct(scene.tracks(camera), camera);
  ASSERT_TRUE(map) << map.error().context;
  EXPECT_LT(error_share(*map, scene), 0.01);
}

TEST(Reconstruct, ACameraThatOnlyTurnsIsRefused) {
  test::MovingRays scene;
  scene.step_m = 0;
  const auto camera = test::wide_camera();
  const auto map = reconstruction::reconstruct(scene.tracks(camera), camera);
  ASSERT_FALSE(map);
  EXPECT_NE(map.error().context.find("turns, but hardly moves"), std::string::npos)
      << map.error().context;
}

TEST(Reconstruct, TracksOfNothingAreRefused) {
  test::MovingRays scene;
  scene.wrong_share = 1;
  const auto camera = test::wide_camera();
  EXPECT_FALSE(reconstruction::reconstruct(scene.tracks(camera), camera));
}

}  // namespace
}  // namespace mixrig
