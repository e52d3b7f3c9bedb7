// SPDX-License-Identifier: Apache-2.0
// A camera in a world with z forward, 1 m before the points of a square, whose pose is wrong by
// known amounts.
#include "host/judge/baselines/slip.h"

#include <cmath>

#include <gtest/gtest.h>

#include "host/run/loop/contact_points.h"
#include "tests/support/count_allocations.h"

namespace mixrig::session {
namespace {

using capture::CameraPose;
using Eigen::Vector3d;

const geometry::Pinhole kSlipView{{640, 480}, 500, 500, 319.5, 239.5};

CameraPose at(double x_m, std::optional<double> sigma_m = std::nullopt) {
  CameraPose pose;
  pose.world_from_target.translation_m = {x_m, 0, 0};
  if (sigma_m) {
    pose.covariance = capture::PoseCovariance::Zero();
    pose.covariance->diagonal().tail<3>().setConstant(*sigma_m * *sigma_m);
  }
  return pose;
}

TEST(SlipWatch, MeasuresTheDistanceToTheTrueProjection) {
  SlipWatch watch({{0, 0, 1}, {0, 0, 2}}, kSlipView);
  const auto first = watch.add(at(0.002), geometry::Pose{});  // 1 px and 0.5 px
  ASSERT_TRUE(first.measured_px);
  EXPECT_NEAR(*first.measured_px, std::sqrt(0.625), 1e-9);
  EXPECT_FALSE(first.sigma_px);
  watch.add(at(-0.004), geometry::Pose{});  // 2 px and 1 px
  const SlipReport report = watch.report();
  ASSERT_TRUE(report.measured);
  EXPECT_NEAR(report.measured->rms_px, std::sqrt((1 + 0.25 + 4 + 1) / 4), 1e-9);
  EXPECT_NEAR(report.measured->max_px, 2, 1e-9);
  EXPECT_NEAR(report.measured->p95_px, 1.85, 0.01);  // between 1 and 2 of 0.5, 1, 1, 2
  EXPECT_FALSE(report.sigma_px || report.within_95_pct);
}

TEST(SlipWatch, PredictsWithoutTruthAndCountsWhatLiesWithin) {
  SlipWatch watch({{0, 0, 1}}, kSlipView);
  const auto frame = watch.add(at(0, 0.001), std::nullopt);  // 0.5 px each way
  EXPECT_FALSE(frame.measured_px);
  ASSERT_TRUE(frame.sigma_px);
  EXPECT_NEAR(*frame.sigma_px, 0.5 * std::sqrt(2.0), 1e-9);
  EXPECT_FALSE(watch.report().measured || watch.report().within_95_pct);
  // 2.447 sigmas hold 95 %: 2.4 within, 2.5 outside.
  watch.add(at(0.0024, 0.001), geometry::Pose{});
  watch.add(at(-0.0024, 0.001), geometry::Pose{});
  watch.add(at(0.0025, 0.001), geometry::Pose{});
  watch.add(at(0.0001, 0.001), geometry::Pose{});
  EXPECT_EQ(watch.report().within_95_pct, 75.0);
}

TEST(SlipWatch, APointCountsThatEitherPoseShows) {
  const double edge_m = 319.9 / 500;  // column 639.4 of -0.5 to 639.5
  SlipWatch watch({{edge_m, 0, 1}}, kSlipView);
  EXPECT_FALSE(watch.add(at(-0.01), at(-0.01).world_from_target).measured_px) << "out of both";
  EXPECT_TRUE(watch.add(at(-0.01), at(0).world_from_target).measured_px) << "drawn out of it";
  EXPECT_TRUE(watch.add(at(0), at(-0.01).world_from_target).measured_px) << "true one out of it";
  SlipWatch behind({{0, 0, -1}}, kSlipView);
  EXPECT_FALSE(behind.add(at(0), geometry::Pose{}).measured_px);
}

TEST(SlipWatch, ALostPoseIsMeasuredButPredictsNothing) {
  SlipWatch watch({{0, 0, 1}}, kSlipView);
  CameraPose lost = at(0.002, 0.001);
  lost.loss = capture::PoseLoss::kTooOld;
  const auto frame = watch.add(lost, geometry::Pose{});
  EXPECT_TRUE(frame.measured_px);
  EXPECT_FALSE(frame.sigma_px);
}

TEST(ContactPoints, AreTheCornersOfTheFootprintInTheWorld) {
  // A table: four feet at z 0 to 0.004, a top of 1 m at z 1; turned by a quarter, raised, doubled.
  const std::vector<glm::vec3> table{{0.3F, 0.2F, 0},  {-0.3F, 0.2F, 0.004F}, {-0.3F, -0.2F, 0},
                                     {0.3F, -0.2F, 0}, {0, 0, 0.002F},        {1, 1, 1},
                                     {-1, -1, 1}};
  render::VirtualObject object;
  object.meshes.emplace_back().positions_m = table;
  object.scale = 2;
  object.world_from_object = {
      Eigen::Quaterniond(Eigen::AngleAxisd(std::acos(0.0), Vector3d::UnitZ())), {5, 6, 0.1}};
  const auto points = contact_points({object, render::VirtualObject{}});
  // x' = 5 - 2 y, y' = 6 + 2 x: feet at (4.6 or 5.4, 6.6 or 5.4).
  ASSERT_GE(points.size(), 2U);
  ASSERT_LE(points.size(), 4U);
  double least_x = 1e9, most_x = -1e9, least_y = 1e9, most_y = -1e9;
  for (const Vector3d& p : points) {
    EXPECT_NEAR(std::abs(p.x() - 5), 0.4, 1e-6);
    EXPECT_NEAR(std::abs(p.y() - 6), 0.6, 1e-6);
    EXPECT_LE(p.z(), 0.1 + 0.0081);
    least_x = std::min(least_x, p.x()), most_x = std::max(most_x, p.x());
    least_y = std::min(least_y, p.y()), most_y = std::max(most_y, p.y());
  }
  EXPECT_NEAR(most_x - least_x, 0.8, 1e-6);
  EXPECT_NEAR(most_y - least_y, 1.2, 1e-6);
}

TEST(SlipWatch, AllocatesNothingAFrame) {
  SlipWatch watch({{0, 0, 1}, {0.1, 0, 1}}, kSlipView);
  const long before = test::allocations;
  watch.add(at(0.001, 0.001), geometry::Pose{});
  EXPECT_EQ(test::allocations, before);
}

}  // namespace
}  // namespace mixrig::session
