// SPDX-License-Identifier: Apache-2.0
// Two paths of one rig, in other axes, units and clocks, and the motion between the maps.
#include "extras/map/reconstruction/maps/map_join.h"

#include <gtest/gtest.h>

namespace mixrig {
namespace {

constexpr double kOffset_s = 0.37, kScale = 0.4;

geometry::Pose rig_at(double t_s, bool still = false) {
  const Eigen::Vector3d turn(0.3 * std::sin(1.1 * t_s), 0.4 * std::sin(0.7 * t_s + 1),
                             0.25 * std::sin(1.7 * t_s));
  const double angle = turn.norm();
  const Eigen::Vector3d place(0.5 * std::sin(0.9 * t_s), 0.3 * std::sin(1.3 * t_s), 0.2 * t_s / 5);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)),
          still ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : place};
}

/// Second camera in the first one's axes; second map in the first one's.
const geometry::Pose kFirstFromSecond{
    Eigen::Quaterniond(Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, 2, -1).normalized())),
    {0.1, -0.05, 0.2}};
const geometry::Pose kMaps{
    Eigen::Quaterniond(Eigen::AngleAxisd(2.1, Eigen::Vector3d(-1, 1, 3).normalized())), {3, -1, 2}};

std::pair<reconstruction::LearnedMap, reconstruction::LearnedMap> two_maps() {
  reconstruction::LearnedMap first, second;
  for (int i = 0; i < 100; ++i) {
    const double t_s = 0.1 * i;
    first.path.push_back({t_s, rig_at(t_s)});
    geometry::Pose pose = geometry::inverse(kMaps) * (rig_at(t_s) * kFirstFromSecond);
    pose.translation_m /= kScale;
    second.path.push_back({t_s - kOffset_s, pose});
  }
  reconstruction::MapPoint point;
  point.place = geometry::inverse(kMaps) * Eigen::Vector3d(1, 2, 3) / kScale;
  point.covariance.setIdentity();
  second.points.push_back(point);
  return {first, second};
}

TEST(MapJoin, PutsAPlaceOfTheSecondMapWhereItIsInTheFirst) {
  const auto [first, second] = two_maps();
  const auto join = reconstruction::join(first, second);
  ASSERT_TRUE(join) << join.error().context;
  EXPECT_NEAR(join->alignment.time_offset_s, kOffset_s, 1e-3);
  EXPECT_NEAR(join->first_from_second.scale, kScale, 1e-3);
  const auto moved = reconstruction::in_first(second, first, *join);
  EXPECT_LT((moved.points[0].place - Eigen::Vector3d(1, 2, 3)).norm(), 0.02);
  EXPECT_NEAR(moved.points[0].covariance(0, 0), kScale * kScale, 1e-3);
  EXPECT_NEAR(moved.path[5].t_s, 0.5, 1e-3);
}

TEST(MapJoin, ARigThatStandsStillIsRefused) {
  auto [first, second] = two_maps();
  for (auto& pose : first.path) pose.world_from_body = first.path[0].world_from_body;
  EXPECT_FALSE(reconstruction::join(first, second));
}

}  // namespace
}  // namespace mixrig
