// SPDX-License-Identifier: Apache-2.0
// The rig of a run that goes on, as a sweep beside it has it.
#include "host/capture/live/session/running_rig.h"

#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

class RunningRigTest : public Session {
 protected:
  capture::Capture with_depth(const LiveSet& set) const {
    capture::Capture capture;
    capture.depth_m.reset({16, 8}, 2.0F);
    capture.pan_tilt = set.pan_tilt;
    return capture;
  }
  RunningRig rig_;
  capture::Capture frame_;
  HostTime exposed_from_{};
};

TEST_F(RunningRigTest, GivesTheNewestCaptureWithTheBeginOfItsExposure) {
  add_head();
  ASSERT_TRUE(session_->start());
  EXPECT_FALSE(rig_.runs());
  EXPECT_EQ(rig_.facts().error().code, ErrorCode::kUsage);
  rig_.follow(config_, devices_, *session_);
  EXPECT_TRUE(rig_.runs());
  EXPECT_EQ(rig_.facts()->color_px, (Size{16, 8}));
  const auto sets = run(100);
  ASSERT_GE(sets.size(), 2U);
  rig_.give(sets[0], with_depth(sets[0]));
  EXPECT_FALSE(rig_.next(0ms, frame_, exposed_from_).value()) << "nobody listened";
  rig_.listen(true);
  rig_.give(sets[0], capture::Capture{});
  EXPECT_FALSE(rig_.next(0ms, frame_, exposed_from_).value()) << "it has no depth";
  rig_.give(sets[0], with_depth(sets[0]));
  rig_.give(sets[1], with_depth(sets[1]));
  ASSERT_TRUE(rig_.next(0ms, frame_, exposed_from_).value());
  EXPECT_EQ(frame_.depth_m.at(3, 3), 2.0F);
  EXPECT_EQ(frame_.pan_tilt->pan_rad, sets[1].pan_tilt->pan_rad);
  EXPECT_EQ(exposed_from_, sets[1].frames.frames[0].mid_exposure - 20ms) << "half of 40 ms";
  EXPECT_FALSE(rig_.next(0ms, frame_, exposed_from_).value()) << "each once";
}

TEST_F(RunningRigTest, TurnsTheHeadUntilTheRunEnds) {
  add_head();
  ASSERT_TRUE(session_->start());
  rig_.follow(config_, devices_, *session_);
  ASSERT_TRUE(rig_.move_to({0.5, 0.25}));
  EXPECT_NEAR(run(200).back().pan_tilt->pan_rad, 0.5, 1e-9);
  ASSERT_TRUE(rig_.halt());
  rig_.end();
  EXPECT_FALSE(rig_.runs());
  EXPECT_EQ(rig_.move_to({0, 0}).error().code, ErrorCode::kUsage);
  EXPECT_EQ(rig_.next(0ms, frame_, exposed_from_).error().code, ErrorCode::kDevice);
}

TEST_F(RunningRigTest, ARigWithoutAHeadIsNoneToSweep) {
  ASSERT_TRUE(session_->start());
  rig_.follow(config_, devices_, *session_);
  EXPECT_FALSE(rig_.runs());
}

}  // namespace
}  // namespace mixrig::live
