// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/pnp.h"

#include <gtest/gtest.h>

#include "host/math/estimation/pose/p3p.h"
#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

struct Scene {
  Points points;
  std::vector<Bearing> bearings;
};

Scene scene_of(Points points, const geometry::Pose& pose, double sigma_rad, double noise_rad,
               std::uint64_t seed) {
  test::RandomGeometry random(seed);
  Scene scene{std::move(points), {}};
  for (const auto& p : scene.points)
    scene.bearings.push_back(
        bearing_of((pose * p).normalized() + random.normal3(noise_rad), sigma_rad));
  return scene;
}

const geometry::Pose kView{rotation_exp({0.3, -0.4, 0.2}), {0.1, -0.2, 4.0}};

TEST(P3p, HoldsTheTruePoseAmongItsSolutions) {
  test::RandomGeometry random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const geometry::Pose truth{random.rotation(), random.in_box(1) + Vector3d(0, 0, 4)};
    std::array<Vector3d, 3> points, rays;
    for (int i = 0; i < 3; ++i) {
      points[i] = random.in_box(1);
      rays[i] = (truth * points[i]).normalized();
    }
    double nearest = 1;
    for (const auto& pose : solve_p3p(points, rays))
      nearest = std::min(nearest, pose_error(pose, truth).norm());
    EXPECT_LT(nearest, 1e-6) << "trial " << trial;
  }
}

TEST(SolvePnp, LeavesOutliersOut) {
  test::RandomGeometry random(4);
  Scene s = scene_of(random.cloud(20, 1), kView, 1e-3, 1e-3, 3);
  for (int i : {2, 9, 13, 17}) s.bearings[i] = bearing_of(random.normal3(), 1e-3);
  const auto fit = solve_pnp(s.points, s.bearings);
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_EQ(fit.inliers.size(), 16u);
  EXPECT_LT(pose_error(fit.value, kView).norm(), 0.01);
}

TEST(SolvePnp, RefusesAPointWithoutABearing) {
  test::RandomGeometry random(6);
  Scene s = scene_of(random.cloud(8, 1), kView, 1e-3, 0, 1);
  s.bearings.pop_back();
  EXPECT_FALSE(solve_pnp(s.points, s.bearings).usable());
}

TEST(BearingOf, WhitensPixelNoiseOfALens) {
  geometry::CameraModel camera{{{640, 480}, 500, 510, 320, 240},
                               geometry::Lens({-0.2, 0.05, 0.001, -0.001, 0, 0, 0, 0})};
  const Eigen::Vector2d px(500, 100);
  const auto bearing = bearing_of(camera, px, 0.5);
  ASSERT_TRUE(bearing);
  EXPECT_LT((*camera.project(bearing->direction) - px).norm(), 1e-9);
  // A small turn of the direction must move the pixel as the whitener states.
  const Vector3d turned = (bearing->direction + Vector3d(1e-6, -2e-6, 5e-7)).normalized();
  const Eigen::Vector2d moved = (*camera.project(turned) - px) / 0.5;
  EXPECT_LT((bearing->whitener * (turned - bearing->direction) - moved).norm(), 1e-6);
}

}  // namespace
}  // namespace mixrig::estimation
