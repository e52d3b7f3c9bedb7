// SPDX-License-Identifier: Apache-2.0
// The contract of PanTilt.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "hal/device/pan_tilt.h"

namespace mixrig::test {

/// A head under test, with its own clock.
struct PanTiltUnderTest {
  std::unique_ptr<device::PanTilt> head;
  Clock* clock = nullptr;
  std::shared_ptr<void> keep{};  ///< what must outlive the head, including the clock
};

struct PanTiltMaker {
  std::string name;
  std::function<PanTiltUnderTest()> make;
  friend void PrintTo(const PanTiltMaker& maker, std::ostream* out) { *out << maker.name; }
};

class PanTiltContract : public ::testing::TestWithParam<PanTiltMaker> {
 protected:
  void SetUp() override {
    under_test_ = GetParam().make();
    ASSERT_TRUE(under_test_.head) << GetParam().name << " cannot be opened";
  }
  void TearDown() override { under_test_.head.reset(); }
  device::PanTilt& head() { return *under_test_.head; }
  Clock& clock() { return *under_test_.clock; }
  void pass(Duration time) { clock().sleep_until(clock().now() + time); }
  double step_rad() { return head().info().resolution.pan_rad; }

  PanTiltUnderTest under_test_;
};

TEST_P(PanTiltContract, InfoIsComplete) {
  const device::PanTiltInfo& info = head().info();
  EXPECT_FALSE(info.uri.empty());
  EXPECT_FALSE(info.version.empty());
  EXPECT_GT(info.resolution.pan_rad, 0);
  EXPECT_GT(info.resolution.tilt_rad, 0);
  EXPECT_LT(info.minimum.pan_rad, info.maximum.pan_rad);
  EXPECT_LT(info.minimum.tilt_rad, info.maximum.tilt_rad);
}

TEST_P(PanTiltContract, ArrivesWithinHalfAStepAndStampsItsSamples) {
  const device::PanTiltAngles target{0.3001, -0.2003};
  ASSERT_TRUE(head().move_to(target));
  ASSERT_TRUE(device::await_position(head(), target, clock(), std::chrono::seconds(10)));
  const HostTime before = clock().now();
  const auto sample = head().sample();
  ASSERT_TRUE(sample);
  EXPECT_NEAR(sample->angles.pan_rad, target.pan_rad, 0.501 * step_rad());
  EXPECT_NEAR(sample->angles.tilt_rad, target.tilt_rad, 0.501 * step_rad());
  EXPECT_GE(sample->pan_at, before);
  EXPECT_LE(sample->tilt_at, clock().now());
}

TEST_P(PanTiltContract, ATargetBeyondTheRangeMovesNothing) {
  for (const device::PanTiltAngles target :
       {device::PanTiltAngles{head().info().maximum.pan_rad + 2 * step_rad(), 0},
        device::PanTiltAngles{0, head().info().minimum.tilt_rad - 2 * step_rad()},
        device::PanTiltAngles{std::nan(""), 0}}) {
    const auto moved = head().move_to(target);
    ASSERT_FALSE(moved);
    EXPECT_EQ(moved.error().code, ErrorCode::kUsage);
  }
  pass(std::chrono::seconds(5));
  EXPECT_EQ(head().sample()->angles.pan_rad, 0);
  EXPECT_EQ(head().sample()->angles.tilt_rad, 0);
}

TEST_P(PanTiltContract, HaltStopsBothAxes) {
  ASSERT_TRUE(head().move_to({2.0, 0.4}));
  pass(std::chrono::milliseconds(200));
  ASSERT_TRUE(head().halt());
  const auto stopped = head().sample();
  ASSERT_TRUE(stopped);
  EXPECT_LT(stopped->angles.pan_rad, 1.9);
  pass(std::chrono::seconds(10));
  const auto later = head().sample();
  ASSERT_TRUE(later);
  EXPECT_NEAR(later->angles.pan_rad, stopped->angles.pan_rad, 1.01 * step_rad());
  EXPECT_NEAR(later->angles.tilt_rad, stopped->angles.tilt_rad, 1.01 * step_rad());
}

TEST_P(PanTiltContract, SpeedIsInRadiansPerSecond) {
  ASSERT_TRUE(head().set_motion({.speed_rad_s = 0.1}));
  ASSERT_TRUE(head().move_to({1.0, 0}));
  const auto begin = head().sample();
  pass(std::chrono::seconds(2));
  const auto end = head().sample();
  ASSERT_TRUE(begin);
  ASSERT_TRUE(end);
  const double rate =
      (end->angles.pan_rad - begin->angles.pan_rad) / seconds(end->pan_at - begin->pan_at);
  EXPECT_NEAR(rate, 0.1, 0.005);
}

TEST_P(PanTiltContract, CommandsAreCounted) {
  const auto before = head().health().commands;
  ASSERT_TRUE(head().sample());
  EXPECT_GT(head().health().commands, before);
  EXPECT_EQ(head().health().timeouts, 0U);
}

}  // namespace mixrig::test
