// SPDX-License-Identifier: Apache-2.0
#include "host/room/sweep/sweep_views.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/each_pixel.h"
#include "tests/support/refusal.h"
#include "tests/unit/run/posed_source.h"

namespace mixrig::session {
namespace {

Crew crew(2);

TEST(SweepViews, FramesOfEqualAnglesAreOneView) {
  test::PosedSource source(7, [](capture::Capture& c) {
    c.pan_tilt = device::PanTiltAngles{c.number <= 3 ? 0.0 : 0.4, 0.1};
    for (int x = 0; x < c.depth_m.width(); ++x)
      c.depth_m.at(x, 3) = 2.0F + 0.02F * static_cast<float>(c.number);
  });
  const calibration_file::PanTilt unit;
  const auto sweep = read_sweep(source, &unit, crew);
  ASSERT_TRUE(sweep) << sweep.error().context;
  EXPECT_EQ(sweep->frames, 7);
  ASSERT_EQ(sweep->views.size(), 2U);
  ASSERT_EQ(sweep->angles.size(), 2U);
  EXPECT_EQ(sweep->angles[1].pan_rad, 0.4);
  EXPECT_FALSE(sweep->world_from_base);
  // Depth is along z: the distance of the pixel nearest to the axis is about the same.
  EXPECT_NEAR(sweep->views[0].distance_m.at(31, 24), 3.0, 0.001);
  const double ratio = sweep->views[1].distance_m.at(31, 3) / sweep->views[0].distance_m.at(31, 3);
  EXPECT_NEAR(ratio, (2.08 + 2.10 + 2.12 + 2.14) / 4 / 2.04, 1e-5);
  EXPECT_LT(sweep->views[1].sigma_m.at(31, 24), sweep->views[0].sigma_m.at(31, 24));
  EXPECT_FALSE(
      sweep->views[1].base_from_tof.rotation.isApprox(sweep->views[0].base_from_tof.rotation));
}

TEST(SweepViews, WhoWalksThroughAViewIsNotInIt) {
  test::PosedSource source(5, [](capture::Capture& c) {
    c.pan_tilt = device::PanTiltAngles{};
    // A column further right in each frame, one metre before what is behind it.
    const int at = 10 * c.number;
    for (const auto [x, y] : test::each_pixel({at, 0}, {at + 10, c.depth_m.height()}))
      c.depth_m.at(x, y) -= 1;
    for (const auto [x, y] : test::each_pixel({at, 0}, {at + 10, c.plate.height()}))
      c.plate.at(x, y) = {0, 0, 250};
  });
  test::PosedSource empty(5, [](capture::Capture& c) { c.pan_tilt = device::PanTiltAngles{}; });
  const calibration_file::PanTilt unit;
  const auto sweep = read_sweep(source, &unit, crew), still = read_sweep(empty, &unit, crew);
  ASSERT_TRUE(sweep && still);
  const model::ScanView &seen = sweep->views.at(0), &room = still->views.at(0);
  for (const auto [x, y] : test::each_pixel(room.distance_m))
    ASSERT_NEAR(seen.distance_m.at(x, y), room.distance_m.at(x, y), 1e-5) << x << ' ' << y;
  for (const auto [x, y] : test::each_pixel(room.plate))
    ASSERT_EQ(seen.plate.at(x, y), room.plate.at(x, y)) << x << ' ' << y;
  // One frame of five is not used.
  EXPECT_NEAR(seen.sigma_m.at(15, 20) / room.sigma_m.at(15, 20), std::sqrt(5.0 / 4), 1e-4);
}

TEST(SweepViews, FramesWithPosesAreViewsAroundTheirMeanPosition) {
  test::PosedSource source(3, [](capture::Capture& c) {
    c.world_from_target.translation_m = {static_cast<double>(c.number), 5, 1};
    c.pose_origin = capture::PoseOrigin::kRecorded;
  });
  const auto sweep = read_sweep(source, nullptr, crew);
  ASSERT_TRUE(sweep) << sweep.error().context;
  ASSERT_EQ(sweep->views.size(), 3U);
  ASSERT_TRUE(sweep->world_from_base);
  EXPECT_TRUE(sweep->world_from_base->translation_m.isApprox(Eigen::Vector3d(2, 5, 1)));
  EXPECT_TRUE(sweep->views[2].base_from_target.translation_m.isApprox(Eigen::Vector3d(1, 0, 0)));
  EXPECT_TRUE(sweep->views[2].base_from_tof.translation_m.isApprox(Eigen::Vector3d(1, 0, 0)));
  EXPECT_FALSE(sweep->views[2].plate.empty());
}

TEST(SweepViews, SaysWhatAFrameLacks) {
  test::PosedSource source(5, [](capture::Capture& c) {
    c.pan_tilt.reset();
    if (c.number < 4) c.pan_tilt = device::PanTiltAngles{};
  });
  const calibration_file::PanTilt unit;
  EXPECT_TRUE(test::refused(read_sweep(source, &unit, crew), {"frame 4 has no angles"}));
  EXPECT_TRUE(test::refused(read_sweep(source, nullptr, crew), {"frame 1 has no pose"}));
}

TEST(SweepViews, MoreViewsThanMemoryHoldsAreRefused) {
  test::PosedSource source(
      kMostViews + 1, [](capture::Capture& c) { c.pose_origin = capture::PoseOrigin::kRecorded; });
  EXPECT_TRUE(test::refused(read_sweep(source, nullptr, crew), {"more than 512 views"}));
}

}  // namespace
}  // namespace mixrig::session
