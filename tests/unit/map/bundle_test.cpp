// SPDX-License-Identifier: Apache-2.0
// Bundles of rays by formula, near to the origin of the map and far from it.
#include "extras/map/reconstruction/views/bundle.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/map/moving_rays.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector3d;

/// Exact rays of random places. The first and the last view are fixed at the truth, the others and
/// the places start a few centimetres off it. The map's origin lies at `origin_m`.
struct DrawnBundle {
  Bundle truth, start;
};

DrawnBundle drawn_bundle(const Vector3d& origin_m) {
  const test::MovingRays path;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto shift = [&] { return Vector3d(unit(random), unit(random), unit(random)); };
  DrawnBundle drawn;
  Bundle& b = drawn.truth;
  for (int p = 0; p < 60; ++p) b.places.push_back(Vector3d(0, 0, 3) + 2 * shift());
  for (int v = 0; v < path.pictures; ++v) {
    b.camera_from_map.push_back(geometry::inverse(path.world_from_camera(v)));
    b.fixed.push_back(v == 0 || v + 1 == path.pictures);
    for (std::size_t p = 0; p < b.places.size(); ++p)
      b.rays.push_back({v, static_cast<int>(p),
                        estimation::bearing_of(b.camera_from_map.back() * b.places[p], 1e-3)});
  }
  drawn.start = b;
  for (std::size_t v = 0; v < b.fixed.size(); ++v)
    if (!b.fixed[v]) drawn.start.camera_from_map[v].translation_m += 0.02 * shift();
  for (Vector3d& p : drawn.start.places) p += 0.05 * shift();
  for (Bundle* each : {&drawn.truth, &drawn.start}) {
    for (geometry::Pose& p : each->camera_from_map) p.translation_m += p.rotation * origin_m;
    for (Vector3d& p : each->places) p -= origin_m;
  }
  return drawn;
}

double most_off_m(const Bundle& found, const Bundle& truth) {
  double most_m = 0;
  for (std::size_t i = 0; i < truth.places.size(); ++i)
    most_m = std::max(most_m, (found.places[i] - truth.places[i]).norm());
  for (std::size_t i = 0; i < truth.fixed.size(); ++i)
    most_m = std::max(most_m, (geometry::inverse(found.camera_from_map[i]).translation_m -
                               geometry::inverse(truth.camera_from_map[i]).translation_m)
                                  .norm());
  return most_m;
}

TEST(Bundle, ExactRaysGiveTheTruthWhereverTheOriginIs) {
  for (const double away_m : {0.0, 1e3}) {
    DrawnBundle drawn = drawn_bundle({away_m, -away_m, away_m});
    const auto fixed = drawn.start.camera_from_map[0].matrix();
    ASSERT_TRUE(adjust(drawn.start, 100, 1)) << away_m;
    EXPECT_LT(most_off_m(drawn.start, drawn.truth), 1e-9) << away_m;
    EXPECT_EQ(drawn.start.camera_from_map[0].matrix(), fixed) << away_m;
  }
}

TEST(Bundle, WhatIsNotFiniteIsRefusedAndNothingMoves) {
  for (int fault = 0; fault < 4; ++fault) {
    DrawnBundle drawn = drawn_bundle({0, 0, 0});
    Bundle& b = drawn.start;
    b.ranges.push_back({0, 0, 3, 0.1});
    if (fault == 0) b.places[3].x() = NAN;
    if (fault == 1) b.camera_from_map[2].translation_m.y() = INFINITY;
    if (fault == 2) b.rays[5].ray.direction.z() = NAN;
    if (fault == 3) b.ranges[0].sigma = 0;
    const Vector3d was = b.places[0];
    const auto found = adjust(b, 20, 1);
    ASSERT_FALSE(found) << fault;
    EXPECT_EQ(found.error().code, ErrorCode::kData);
    EXPECT_NE(found.error().context.find("not a finite number"), std::string::npos);
    EXPECT_EQ(b.places[0], was) << fault;
  }
}

}  // namespace
}  // namespace mixrig::reconstruction
