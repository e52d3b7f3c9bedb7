// SPDX-License-Identifier: Apache-2.0
// The angle of a moving head: a set waits for the next position, for a limited time.
#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

/// Turns at a constant rate; its answers are `lag` old when they arrive.
class TurningHead final : public device::PanTilt {
 public:
  TurningHead(Clock& clock, Duration lag) : clock_(clock), lag_(lag) {}
  static device::PanTiltAngles angles(HostTime at) {
    const double t_s = seconds(at.time_since_epoch());
    return {0.01 * t_s, -0.02 * t_s};
  }
  const device::PanTiltInfo& info() const override { return info_; }
  Result<void> move_to(device::PanTiltAngles) override { return {}; }
  Result<void> set_motion(device::PanTiltMotion) override { return {}; }
  Result<device::PanTiltSample> sample() override {
    const HostTime at = clock_.now() - lag_;
    return device::PanTiltSample{angles(at), at, at};
  }
  Result<void> halt() override { return {}; }
  device::PanTiltHealth health() const override { return {}; }

 private:
  Clock& clock_;
  Duration lag_;
  device::PanTiltInfo info_;
};

TEST_F(Session, AMovingHeadsAngleIsAwaited) {
  devices_.pan_tilt = std::make_unique<TurningHead>(clock_, 45ms);
  ASSERT_TRUE(session_->start());
  const auto sets = run(400);
  EXPECT_EQ(sets.size(), 97U) << "two frames to lock, one that waits";
  for (const LiveSet& set : sets) {
    ASSERT_TRUE(set.pan_tilt);
    const auto truth = TurningHead::angles(set.frames.frames[0].mid_exposure);
    EXPECT_NEAR(set.pan_tilt->pan_rad, truth.pan_rad, 1e-9);
    EXPECT_NEAR(set.pan_tilt->tilt_rad, truth.tilt_rad, 1e-9);
  }
  session_->stop();
  EXPECT_EQ(session_->report().sets_without_angle, 1U) << "the one that waited when it was stopped";
  EXPECT_EQ(session_->report().dropped_sets, 0U);
}

TEST_F(Session, AHeadThatAnswersTooLateCostsItsAngleAndNoSet) {
  devices_.pan_tilt = std::make_unique<TurningHead>(clock_, 400ms);
  ASSERT_TRUE(session_->start());
  const auto sets = run(400);
  EXPECT_EQ(sets.size(), 94U);
  for (const LiveSet& set : sets) {
    EXPECT_FALSE(set.pan_tilt) << "marked, not guessed";
    EXPECT_LE(clock_.now() - set.frames.frames[0].mid_exposure, 4s);
  }
  EXPECT_EQ(session_->report().sets_without_angle, 94U);
  EXPECT_EQ(session_->report().dropped_sets, 0U);
  session_->stop();
}

TEST_F(Session, MovesItsHeadBetweenTwoAnswers) {
  add_head();
  ASSERT_FALSE(session_->move_head({0.5, 0})) << "it does not run";
  ASSERT_TRUE(session_->start());
  ASSERT_TRUE(session_->move_head({0.5, 0.25}));
  const auto sets = run(200);
  ASSERT_FALSE(sets.empty());
  ASSERT_TRUE(sets.back().pan_tilt);
  EXPECT_NEAR(sets.back().pan_tilt->pan_rad, 0.5, 1e-9);
  EXPECT_NEAR(sets.back().pan_tilt->tilt_rad, 0.25, 1e-9);
  EXPECT_EQ(session_->move_head({9, 0}).error().code, ErrorCode::kUsage) << "its own error";
  ASSERT_TRUE(session_->move_head({-2, 0.25}));
  ASSERT_TRUE(session_->halt_head());
  const auto halted = run(200);
  EXPECT_GT(halted.back().pan_tilt->pan_rad, 0.45);
  head_->set_fault(fake::FakePanTilt::Fault::kSilent);
  EXPECT_EQ(session_->move_head({0.1, 0}).error().code, ErrorCode::kTimeout);
  session_->stop();
  EXPECT_EQ(session_->move_head({0.5, 0}).error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace mixrig::live
