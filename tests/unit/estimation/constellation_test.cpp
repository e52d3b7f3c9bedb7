// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/markers/constellation.h"

#include <gtest/gtest.h>

#include "tests/support/random_geometry.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

const Points kBody_m = {
    {0, 0, 0}, {0.21, 0, 0}, {0.05, 0.16, 0}, {0.02, 0.07, 0.11}, {-0.09, 0.03, 0.05}};
const geometry::Pose kPose{rotation_exp({0.5, 1.0, -2.0}), {1, 2, 3}};

Points seen(const Points& body, double noise_m, std::uint64_t seed) {
  test::RandomGeometry random(seed);
  Points points;
  for (const auto& p : body) points.push_back(kPose * p + random.normal3(noise_m));
  return points;
}

TEST(MatchConstellation, LabelsShuffledMarkersAmongForeignOnes) {
  const Points all = seen(kBody_m, 0.0005, 1);
  const Points observed = {all[3], {1.2, 2.1, 3.3}, all[0], all[4], {0.8, 2, 3}, all[1], all[2]};
  const auto match = match_constellation(kBody_m, observed, {0.0005, 0});
  ASSERT_TRUE(match.usable()) << match.verdict.reason;
  EXPECT_EQ(match.value.marker_of_point, (std::vector<int>{3, -1, 0, 4, -1, 1, 2}));
  EXPECT_LT(pose_error(match.value.world_from_body, kPose).norm(), 0.02);
  EXPECT_EQ(match.inliers, (std::vector<int>{0, 2, 3, 5, 6}));
}

TEST(MatchConstellation, BearsAHiddenMarker) {
  Points observed = seen(kBody_m, 0.0005, 2);
  observed.erase(observed.begin() + 1);
  const auto match = match_constellation(kBody_m, observed, {0.0005, 0});
  ASSERT_TRUE(match.usable()) << match.verdict.reason;
  EXPECT_EQ(match.value.marker_of_point, (std::vector<int>{0, 2, 3, 4}));
}

TEST(MatchConstellation, RefusesASymmetricBody) {
  const Points isosceles = {{0.1, 0, 0}, {-0.1, 0, 0}, {0, 0.2, 0}};
  const auto match = match_constellation(isosceles, seen(isosceles, 0.0005, 3), {0.0005, 0});
  EXPECT_FALSE(match.usable());
  EXPECT_NE(match.verdict.reason.find("symmetric"), std::string::npos) << match.verdict.reason;
  EXPECT_EQ(check_constellation(isosceles, 0.0005).standing, Standing::kDegenerate);
  EXPECT_NE(check_constellation(kBody_m, 0.0005).standing, Standing::kDegenerate);
}

TEST(MatchConstellation, RefusesForeignPointsAndBrokenInput) {
  test::RandomGeometry random(4);
  EXPECT_FALSE(match_constellation(kBody_m, random.cloud(10, 0.3), {0.0002, 0}).usable());
  EXPECT_FALSE(match_constellation(kBody_m, Points{}, {}).usable());
  Points two = seen(kBody_m, 0, 5);
  two.resize(2);
  EXPECT_FALSE(match_constellation(kBody_m, two, {}).usable());
  Points hole = seen(kBody_m, 0, 5);
  hole[0].x() = NAN;
  EXPECT_FALSE(match_constellation(kBody_m, hole, {}).usable());
  EXPECT_FALSE(match_constellation(kBody_m, seen(kBody_m, 0, 5), {0.0, 0}).usable());
}

TEST(MatchConstellation, RefusesAMirroredDefinition) {
  Points mirrored = kBody_m;
  for (auto& p : mirrored) p.x() = -p.x();
  EXPECT_FALSE(match_constellation(mirrored, seen(kBody_m, 0.0003, 6), {0.0003, 0}).usable());
}

TEST(MatchConstellation, RefusesACrowdThatAgreesWithEverything) {
  test::RandomGeometry random(3);
  const auto crowd = random.cloud(64, 0.1);
  EXPECT_FALSE(check_constellation(crowd, 0.01).reason.empty());
  EXPECT_FALSE(match_constellation(crowd, crowd, {0.01, 0}).usable());
}

}  // namespace
}  // namespace mixrig::estimation
