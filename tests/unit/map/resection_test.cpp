// SPDX-License-Identifier: Apache-2.0
// Poses from places and rays against the poses that made the rays.
#include "extras/map/reconstruction/views/resection.h"

#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "extras/map/reconstruction/views/rays.h"
#include "host/math/estimation/verdict.h"
#include "tests/unit/map/moving_rays.h"

namespace mixrig {
namespace {

struct SeenPlaces {
  std::vector<Eigen::Vector3d> places;
  std::vector<estimation::Bearing> rays;
  geometry::Pose camera_from_map;
};

SeenPlaces seen_places(unsigned seed, double noise_px, double wrong_share) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> noise(0, noise_px);
  const auto camera = test::wide_camera();
  SeenPlaces seen;
  seen.camera_from_map = {
      estimation::rotation_exp({0.3 * unit(random), 0.3 * unit(random), unit(random)}),
      {0.5 * unit(random), 0.5 * unit(random), 0.5 * unit(random)}};
  constexpr int kPlaces = 80;
  for (int i = 0; i < kPlaces; ++i) {
    const Eigen::Vector3d p(2 * unit(random), 2 * unit(random), 2.5 + unit(random));
    auto px = geometry::project(camera, p);
    if (!px) continue;
    *px += Eigen::Vector2d(noise(random), noise(random));
    if (i < wrong_share * kPlaces) *px += Eigen::Vector2d(100 * unit(random), 100 * unit(random));
    const auto ray = reconstruction::ray_of(camera, *px, 0.3);
    if (!ray) continue;
    seen.places.push_back(geometry::inverse(seen.camera_from_map) * p);
    seen.rays.push_back(*ray);
  }
  return seen;
}

/// e^T C^-1 e; the covariance turns the translation with the rotation.
double nees_of_pose(const reconstruction::Resection& found, const geometry::Pose& truth) {
  Eigen::Matrix<double, 6, 1> e = estimation::pose_error(truth, found.camera_from_map);
  e.tail<3>() = truth.translation_m -
                estimation::rotation_exp(e.head<3>()) * found.camera_from_map.translation_m;
  return e.dot(found.covariance.ldlt().solve(e));
}

TEST(Resection, FindsThePoseWithoutAStartAmongFortyPercentWrongRays) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const SeenPlaces seen = seen_places(seed, 0.3, 0.4);
    const auto found = reconstruction::find_pose(seen.places, seen.rays);
    ASSERT_TRUE(found) << seed;
    // A chi-squared value of 6 dimensions is below 30 in all but 4 of 100000 cases.
    EXPECT_LT(nees_of_pose(*found, seen.camera_from_map), 30) << seed;
  }
}

TEST(Resection, CovarianceHoldsTheError) {
  double sum = 0;
  constexpr int kRuns = 60;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const SeenPlaces seen = seen_places(seed, 0.3, 0);
    const auto found = reconstruction::refine_pose(seen.places, seen.rays, seen.camera_from_map);
    ASSERT_TRUE(found);
    sum += nees_of_pose(*found, seen.camera_from_map);
  }
  EXPECT_NEAR(sum / kRuns, 6, 1.5);
}

TEST(Resection, PlacesOfAnotherRoomGiveNoPose) {
  const SeenPlaces a = seen_places(1, 0.3, 0), b = seen_places(2, 0.3, 1);
  const std::size_t count = std::min(a.places.size(), b.rays.size());
  const auto found = reconstruction::find_pose({a.places.data(), count}, {b.rays.data(), count});
  EXPECT_TRUE(!found || found->inliers.size() < 15);
}

}  // namespace
}  // namespace mixrig
