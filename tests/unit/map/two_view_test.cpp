// SPDX-License-Identifier: Apache-2.0
// The motion between two pictures against the motion that made them.
#include "extras/map/reconstruction/views/two_view.h"

#include <gtest/gtest.h>

#include "extras/map/reconstruction/views/rays.h"
#include "tests/unit/map/moving_rays.h"

namespace mixrig {
namespace {

using reconstruction::RayPair;

std::vector<RayPair> pairs_of_pictures(const test::MovingRays& scene, int a, int b) {
  const auto camera = test::wide_camera();
  std::vector<RayPair> pairs;
  for (const auto& track : scene.tracks(camera).tracks) {
    const auto& seen = track.seen;
    if (static_cast<int>(seen.size()) <= b) continue;
    const auto ray_a = reconstruction::ray_of(camera, seen[static_cast<std::size_t>(a)].px, 0.3);
    const auto ray_b = reconstruction::ray_of(camera, seen[static_cast<std::size_t>(b)].px, 0.3);
    if (ray_a && ray_b) pairs.push_back({*ray_a, *ray_b});
  }
  return pairs;
}

void expect_motion(const test::MovingRays& scene, double most_rad) {
  const auto views = reconstruction::relate_views(pairs_of_pictures(scene, 0, 8));
  ASSERT_TRUE(views);
  const geometry::Pose truth =
      geometry::inverse(scene.world_from_camera(8)) * scene.world_from_camera(0);
  EXPECT_LT(views->b_from_a.rotation.angularDistance(truth.rotation), most_rad);
  const double along = views->b_from_a.translation_m.dot(truth.translation_m.normalized());
  EXPECT_GT(along, std::cos(4 * most_rad));
  EXPECT_LT(views->turned_share, 0.5);
}

TEST(TwoView, FindsTheMotion) { expect_motion({}, 0.01); }

TEST(TwoView, FindsTheMotionAmongFortyPercentWrongPairs) {
  test::MovingRays scene;
  scene.wrong_share = 0.4;
  expect_motion(scene, 0.01);
}

TEST(TwoView, ATurnAloneExplainsWhatATurningCameraSees) {
  test::MovingRays scene;
  scene.step_m = 0;
  const auto views = reconstruction::relate_views(pairs_of_pictures(scene, 0, 8));
  ASSERT_TRUE(views);
  EXPECT_GT(views->turned_share, 0.95);
}

TEST(TwoView, FewPairsGiveNothing) {
  auto pairs = pairs_of_pictures({}, 0, 8);
  pairs.resize(10);
  EXPECT_FALSE(reconstruction::relate_views(pairs));
}

}  // namespace
}  // namespace mixrig
