// SPDX-License-Identifier: Apache-2.0
// One fault at a time in a running session: it is reported and counted, nothing is paired wrongly,
// and two seconds after its end the rig delivers as before. The test controls the time.
#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/support/refusal.h"
#include "tests/support/throw_in.h"
#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

using Status = sync::PairStatus;

/// Frames that are in no set with the tick that fired them: colour and depth of this rig fire on
/// every fourth tick, so the counter determines the tick.
class SessionFault : public Session {
 protected:
  std::vector<LiveSet> run_and_check(int ticks) {
    auto sets = run(ticks);
    for (const LiveSet& set : sets) {
      EXPECT_EQ(set.frames.tick + first_of_color_, 4 * set.frames.frames[0].frame->sequence)
          << "colour of another tick";
      if (!set.frames.frames[2].frame) continue;
      EXPECT_EQ(set.frames.tick + first_of_color_, 4 * set.frames.frames[2].frame->sequence)
          << "depth of another tick";
    }
    return sets;
  }
  /// Delivers one whole set for every colour frame.
  void expect_healthy() {
    const auto sets = run_and_check(80);
    EXPECT_EQ(sets.size(), 20U);
    for (const LiveSet& set : sets) EXPECT_TRUE(set.frames.frames[2].frame);
  }
  std::uint64_t of(std::size_t stream, Status status) {
    return session_->report().streams[stream].pairing.of(status);
  }
  std::uint64_t first_of_color_ = 4;  ///< 4 * counter - tick: counter 1 is tick 0
};

TEST_F(SessionFault, DroppedFramesAreLostAndMissing) {
  ASSERT_TRUE(session_->start());
  run_and_check(80);
  color_->drop_next(3);
  const auto sets = run_and_check(40);
  EXPECT_EQ(sets.size(), 7U);
  expect_healthy();
  session_->stop();
  EXPECT_EQ(session_->report().streams[0].health.lost, 3U);
  EXPECT_EQ(session_->report().streams[0].pairing.missing, 3U);
}

TEST_F(SessionFault, ADoubledFrameIsADuplicateAndUsedOnce) {
  ASSERT_TRUE(session_->start());
  run_and_check(80);
  for (int i = 0; i < 5; ++i) {
    run_and_check(4);
    color_->repeat();
  }
  expect_healthy();
  session_->stop();
  EXPECT_EQ(of(0, Status::kDuplicate), 5U);
}

TEST_F(SessionFault, ADamagedDepthFrameLeavesTheSetWithoutDepth) {
  ASSERT_TRUE(session_->start());
  run_and_check(80);
  depth_->damage_next();
  int without = 0;
  for (const LiveSet& set : run_and_check(40)) without += set.frames.frames[2].frame ? 0 : 1;
  EXPECT_EQ(without, 1);
  expect_healthy();
  session_->stop();
  EXPECT_EQ(session_->report().streams[2].health.incomplete, 1U);
  EXPECT_EQ(session_->report().incomplete_sets, 1U + 4U) << "four before the slower camera locks";
}

TEST_F(SessionFault, ATriggerBoardThatWasResetCountsFromZero) {
  ASSERT_TRUE(session_->start());
  run_and_check(84);
  trigger_->reset();
  clock_.advance(300ms);
  ASSERT_TRUE(trigger_->wait_for_start(2, 60s));
  first_of_color_ += 84;  // the cameras' counters continue, the ticks start at 0
  const HostTime back = clock_.now();
  std::vector<LiveSet> sets;
  while (sets.empty() && clock_.now() - back < 10s) sets = run_and_check(4);
  EXPECT_LT(clock_.now() - back, 2s);
  expect_healthy();
  session_->stop();
  EXPECT_EQ(session_->report().trigger_restarts, 1U);
}

TEST_F(SessionFault, ASilentHeadLeavesSetsWithoutAnAngleAndComesBack) {
  add_head();
  ASSERT_TRUE(session_->start());
  for (const LiveSet& set : run_and_check(80)) {
    ASSERT_TRUE(set.pan_tilt);
    EXPECT_NEAR(set.pan_tilt->pan_rad, 0.25, 1e-9);
  }
  for (const auto fault : {fake::FakePanTilt::Fault::kSilent, fake::FakePanTilt::Fault::kGarbage}) {
    const auto errors = session_->report().pan_tilt_errors;
    head_->set_fault(fault);
    run_and_check(80);  // for half a second it is assumed to stand still
    for (const LiveSet& set : run_and_check(40)) EXPECT_FALSE(set.pan_tilt) << "unknown angle";
    EXPECT_GT(session_->report().pan_tilt_errors, errors);
    head_->set_fault(fake::FakePanTilt::Fault::kNone);
    run_and_check(4);
    for (const LiveSet& set : run_and_check(40)) EXPECT_TRUE(set.pan_tilt);
  }
  session_->stop();
  EXPECT_GT(session_->report().pan_tilt.timeouts, 0U);
  EXPECT_GT(session_->report().pan_tilt.noise_bytes, 0U);
}

TEST_F(SessionFault, WhatAThreadThrowsEndsTheSession) {
  add_head();
  ASSERT_TRUE(session_->start());
  run_and_check(40);
  EXPECT_TRUE(session_->fault());
  EXPECT_FALSE(session_->ended());
  head_->set_fault(fake::FakePanTilt::Fault::kThrows);
  clock_.advance(10ms);
  wait([&] { return session_->ended(); });
  EXPECT_TRUE(
      test::refused(session_->fault(), {"pan-tilt unit: no memory is left"}, ErrorCode::kIo));
  EXPECT_FALSE(session_->halt_head()) << "nobody waits for its thread";
  session_->stop();
}

TEST_F(SessionFault, WhatPairingOrReadingTheTriggerThrowsEndsTheSession) {
  for (const char* name : {"pairing of frames", "trigger"}) {
    const test::ThrowIn thrown(name);
    session_.emplace(config_, devices_, clock_);
    ASSERT_TRUE(session_->start()) << name;
    wait([&] { return session_->ended(); });
    EXPECT_TRUE(test::refused(session_->fault(), {name, "no memory is left"}, ErrorCode::kIo));
    session_->stop();
  }
}

TEST_F(SessionFault, ALimitThatTheHeadHitsIsReported) {
  add_head();
  ASSERT_TRUE(session_->start());
  run_and_check(40);
  head_->hit_limit();
  run_and_check(40);
  session_->stop();
  EXPECT_EQ(session_->report().pan_tilt.limit_hits, 1U);
  EXPECT_TRUE(session_->report().pan_tilt.limit_hit);
}

TEST(FreeRunningRig, CamerasOfAnyRateArePairedWithoutAMaster) {
  for (const double rate_hz : {2.0, 8.0, 24.0, 25.0, 30.1, 60.0}) {
    test::SteppedClock clock;
    RigConfig config;
    config.cameras.emplace_back();
    config.depth.emplace();
    Devices devices;
    auto info = fake_info(device::PixelFormat::kRgb8);
    info.rate_hz = rate_hz;
    auto color = std::make_unique<fake::FakeCamera>(clock, info, 64);
    info.format = device::PixelFormat::kDepth16;
    auto depth = std::make_unique<fake::FakeCamera>(clock, info, 64);
    auto *color_camera = color.get(), *depth_camera = depth.get();
    devices.cameras.push_back(std::move(color));
    devices.depth = device::as_depth_camera(std::move(depth), {});
    LiveSession session(config, devices, clock);
    ASSERT_TRUE(session.start());
    int sets = 0;
    for (int frame = 0; frame < 100; ++frame) {
      clock.advance(Duration(std::llround(1e9 / rate_hz)));
      color_camera->emit();
      depth_camera->emit();
      ASSERT_TRUE(test::comes_true([&] { return session.report().waiting_events == 0; }));
      while (const auto set = session.next(0ms)) {
        EXPECT_EQ(set->frames.frames[0].frame->sequence, set->frames.frames[1].frame->sequence);
        ++sets;
      }
    }
    EXPECT_EQ(sets, 100) << rate_hz << " Hz";
    session.stop();
  }
}

/// 25.00 and 25.02 Hz: in 50 s the phase of the two goes through a whole period, and depth has one
/// frame more.
TEST(FreeRunningRig, EveryFrameIsAccountedForOverAWholeBeat) {
  test::SteppedClock clock;
  RigConfig config;
  config.cameras.emplace_back();
  config.depth.emplace();
  Devices devices;
  auto info = fake_info(device::PixelFormat::kRgb8);
  auto color = std::make_unique<fake::FakeCamera>(clock, info, 64);
  info.format = device::PixelFormat::kDepth16, info.rate_hz = 25.02;
  auto depth = std::make_unique<fake::FakeCamera>(clock, info, 64);
  auto *color_camera = color.get(), *depth_camera = depth.get();
  devices.cameras.push_back(std::move(color));
  devices.depth = device::as_depth_camera(std::move(depth), {});
  LiveSession session(config, devices, clock);
  ASSERT_TRUE(session.start());
  const HostTime begin = clock.now();
  std::vector<HostTime> color_at, depth_at;
  std::vector<std::uint64_t> colors, depths;
  double worst_s = 0;
  const auto exposed_at = [&](std::size_t frames, double rate_hz) {
    return begin + Duration(std::llround(1e9 * static_cast<double>(frames + 1) / rate_hz));
  };
  while (color_at.size() < 1500) {  // 60 s
    const HostTime next_color = exposed_at(color_at.size(), 25),
                   next_depth = exposed_at(depth_at.size(), 25.02);
    clock.advance(std::min(next_color, next_depth) - clock.now());
    (next_color < next_depth ? color_at : depth_at).push_back(clock.now());
    (next_color < next_depth ? color_camera : depth_camera)->emit();
    ASSERT_TRUE(test::comes_true([&] { return session.report().waiting_events == 0; }));
    while (const auto set = session.next(0ms)) {
      const auto& frames = set->frames.frames;
      colors.push_back(frames[0].frame->sequence);
      if (!frames[1].frame) continue;
      depths.push_back(frames[1].frame->sequence);
      worst_s = std::max(worst_s, std::abs(seconds(color_at.at(colors.back() - 1) -
                                                   depth_at.at(depths.back() - 1))));
    }
  }
  session.stop();
  while (const auto set = session.next(0ms))
    colors.push_back(set->frames.frames[0].frame->sequence);
  ASSERT_EQ(colors.size(), color_at.size()) << "each colour frame is in a set";
  for (std::size_t i = 0; i < colors.size(); ++i) ASSERT_EQ(colors[i], i + 1) << "once, in order";
  EXPECT_TRUE(std::is_sorted(depths.begin(), depths.end(), std::less_equal<>()))
      << "no depth frame twice";
  EXPECT_LE(worst_s, 0.03);
  EXPECT_GE(depths.size(), color_at.size() - 3);
}

/// The colour camera stamps by a clock of its own, which is set: the host's CLOCK_REALTIME
/// in libaravis' fake camera, PTP in real ones.
class SteppedDeviceClock : public SessionFault,
                           public ::testing::WithParamInterface<std::chrono::milliseconds> {
 protected:
  void SetUp() override {
    color_stamps_ = device::StampClock::kDevice;
    SessionFault::SetUp();
  }
};

TEST_P(SteppedDeviceClock, PairsNothingWronglyAndRecoversWithinTwoSeconds) {
  ASSERT_TRUE(session_->start());
  run_and_check(400);
  color_->set_clock(GetParam());
  const HostTime back = clock_.now();
  std::vector<LiveSet> sets;
  while (sets.empty() && clock_.now() - back < 10s) sets = run_and_check(4);
  EXPECT_LT(clock_.now() - back, 2s);
  run_and_check(200);
  expect_healthy();
  session_->stop();
}

INSTANTIATE_TEST_SUITE_P(Steps, SteppedDeviceClock,
                         ::testing::Values(1h, -1h, 1000ms, -1000ms, 100ms, -100ms, 30ms, -30ms,
                                           8ms, -8ms),
                         [](const auto& step) {
                           const auto ms = step.param.count();
                           return (ms < 0 ? "back_" : "ahead_") + std::to_string(std::abs(ms));
                         });

}  // namespace
}  // namespace mixrig::live
