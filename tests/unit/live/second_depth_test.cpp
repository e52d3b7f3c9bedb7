// SPDX-License-Identifier: Apache-2.0
// A rig whose two depth cameras fire half a frame apart.
#include "host/capture/live/session/live_capture.h"
#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

class SecondDepth : public Session {
 protected:
  void SetUp() override {
    Session::SetUp();
    config_.lines.push_back({2, {.divider = 4, .phase = 20ms, .width = 1ms}});
    config_.depth2 = config_.depth;
    config_.depth2->name = "depth2";
    config_.depth2->trigger_line = 2;
    config_.depth2->delay = 3ms;
    auto camera =
        std::make_unique<fake::FakeCamera>(clock_, fake_info(device::PixelFormat::kDepth16), 256);
    depth2_ = camera.get();
    devices_.depth2 = device::as_depth_camera(std::move(camera), {});
    session_.emplace(config_, devices_, clock_);
  }
  std::vector<LiveSet> run_both(int ticks, bool second_sends = true) {
    std::vector<LiveSet> sets;
    for (int i = 0; i < ticks; ++i) {
      tick();
      if (second_sends && (ticked_ - 1) % 4 == 2) {
        depth2_->emit();
        wait([&] { return session_->report().waiting_events == 0; });
      }
      while (auto set = session_->next(0ms)) sets.push_back(*std::move(set));
    }
    return sets;
  }
  fake::FakeCamera* depth2_ = nullptr;
};

constexpr std::size_t kFirst = 2, kSecond = 3;  ///< after the two cameras of the rig

TEST_F(SecondDepth, JoinsTheSetOfTheNearestPlateWithItsOwnTime) {
  ASSERT_TRUE(session_->start());
  const std::vector<LiveSet> sets = run_both(80);
  ASSERT_GT(sets.size(), 10U);
  int paired = 0;
  for (std::size_t i = 5; i < sets.size(); ++i) {
    const sync::FrameSet& set = sets[i].frames;
    if (!set.frames[kFirst].frame || !set.frames[kSecond].frame) continue;
    ++paired;
    EXPECT_EQ(set.frames[kFirst].pairing.tick, set.tick);
    EXPECT_EQ(set.frames[kSecond].pairing.tick % 4, 2U);
    const auto apart = set.frames[kSecond].mid_exposure - set.frames[0].mid_exposure;
    EXPECT_NEAR(milliseconds(apart), -17, 6) << "nearer in time than the next, 23 ms later";
  }
  const SessionReport report = session_->report();
  EXPECT_GE(paired, static_cast<int>(sets.size()) - 7);
  ASSERT_EQ(report.streams.size(), 4U);
  EXPECT_EQ(report.streams[kSecond].name, "depth2");
  session_->stop();
}

TEST_F(SecondDepth, IsInTheCaptureAndMissingWhereItSendsNothing) {
  ASSERT_TRUE(session_->start());
  SetDecoder decoder(config_, devices_);
  std::vector<LiveSet> sets = run_both(60);
  ASSERT_FALSE(sets.empty());
  capture::Capture capture;
  ASSERT_TRUE(decoder.decode(sets.back(), capture));
  EXPECT_EQ(capture.status_of(capture::Stream::kDepth2), capture::StreamStatus::kFresh);
  EXPECT_EQ(capture.depth2.depth_m.size(), (Size{16, 8}));
  EXPECT_EQ(capture.depth2.mid_exposure, sets.back().frames.frames[kSecond].mid_exposure);
  sets = run_both(40, false);
  ASSERT_GT(sets.size(), 4U) << "plates and the first depth camera go on";
  ASSERT_TRUE(decoder.decode(sets.back(), capture));
  EXPECT_EQ(capture.status_of(capture::Stream::kDepth2), capture::StreamStatus::kMissing);
  EXPECT_TRUE(capture.depth2.depth_m.empty());
  EXPECT_EQ(capture.status_of(capture::Stream::kDepth), capture::StreamStatus::kFresh);
  session_->stop();
}

TEST_F(SecondDepth, IsInTheTakeWithTheTimeBetweenTheTriggers) {
  config_.depth2_steps.unit_m = 0.0005;
  config_.depth2_steps.kind = device::DepthMeaning::kDistance;
  const auto info = take_info(config_, devices_);
  ASSERT_TRUE(info) << to_line(info.error());
  ASSERT_TRUE(info->tof2 && info->depth2);
  EXPECT_EQ(info->tof2->unit_m, 0.0005);
  EXPECT_EQ(info->tof2->kind, capture::DepthKind::kDistance);
  EXPECT_EQ(info->tof2->model.size_px(), (Size{16, 8}));
  EXPECT_NEAR(std::abs(info->depth2->depth.delay_s), 0.0195, 0.0036) << "+23 or -17 ms";
  config_.tof2 = info->tof2->model;
  config_.tof2->pinhole.fx_px = 21;
  config_.target_from_tof2 = geometry::Pose{Eigen::Quaterniond::Identity(), {-0.1, 0, 0}};
  const auto given = take_info(config_, devices_);
  ASSERT_TRUE(given);
  EXPECT_EQ(given->tof2->model.pinhole.fx_px, 21);
  EXPECT_EQ(given->tof2->target_from_tof.translation_m.x(), -0.1);
}

}  // namespace
}  // namespace mixrig::live
