// SPDX-License-Identifier: Apache-2.0
// The sweep of a unit in injected time: late settling, overshoot, lost frames, a lost unit, and an
// interruption.
#include "host/capture/live/sweep/sweep.h"

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "hal/base/angles.h"

namespace mixrig::live {
namespace {

using namespace std::chrono_literals;
using device::PanTiltAngles;

constexpr double kSweepStep_rad = 0.001;
constexpr Size kPlate{96, 64};

/// A pan-tilt unit with cameras of 25 Hz. Each call of next() is one frame later.
class FakeSweepRig final : public SweepRig {
 public:
  explicit FakeSweepRig(ManualClock& clock) : clock_(clock) {}

  PanTiltAngles step() const override { return {kSweepStep_rad, kSweepStep_rad}; }
  Result<void> move_to(PanTiltAngles target) override {
    if (refuses) return Error{ErrorCode::kTimeout, "the unit does not answer"};
    from_ = at(clock_.now()), to_ = {target.pan_rad - short_by_rad, target.tilt_rad},
    moved_ = clock_.now();
    targets.push_back(target);
    return {};
  }
  Result<void> halt() override {
    ++halts;
    return {};
  }
  Result<bool> next(Duration, capture::Capture& frame, HostTime& exposed_from) override {
    clock_.advance(40ms);
    ++number_;
    if (on_frame) on_frame(number_);
    if (frames_lost || dropped.contains(number_)) return false;
    const HostTime middle = clock_.now() - 10ms;
    exposed_from = middle - 20ms;
    frame.number = number_;
    frame.mid_exposure = middle;
    frame.set_status(capture::Stream::kDepth, capture::StreamStatus::kFresh);
    frame.pan_tilt.reset();
    if (!unit_lost) frame.pan_tilt = at(middle);
    draw(frame, shift_px(middle));
    return true;
  }

  void home() { from_ = to_ = {}; }

  std::vector<PanTiltAngles> targets;
  int halts = 0;
  std::function<void(int number)> on_frame;
  std::set<int> dropped;  ///< numbers of frames that do not come
  bool refuses = false, unit_lost = false, frames_lost = false, stuck = false;
  double overshoot_rad = 0;     ///< for 0.2 s after the unit arrived
  double swing_px = 0;          ///< of the picture at the arrival
  Duration swing_time = 300ms;  ///< until a third of it is left
  double short_by_rad = 0;      ///< where the unit stops
  double seconds_to_arrive = 0.4;

 private:
  PanTiltAngles at(HostTime time) const {
    if (stuck) return from_;
    const double part = std::clamp(seconds(time - moved_) / seconds_to_arrive, 0.0, 1.0);
    const double since_s = seconds(time - moved_) - seconds_to_arrive;
    PanTiltAngles now{from_.pan_rad + part * (to_.pan_rad - from_.pan_rad),
                      from_.tilt_rad + part * (to_.tilt_rad - from_.tilt_rad)};
    if (since_s > 0.06 && since_s < 0.26) now.pan_rad += overshoot_rad;
    return now;
  }
  double shift_px(HostTime time) const {
    const double since_s = seconds(time - moved_) - seconds_to_arrive;
    if (since_s < 0) return 5 * since_s;
    return swing_px * std::exp(-since_s / seconds(swing_time)) * std::cos(2 * kPi * 3.1 * since_s);
  }
  void draw(capture::Capture& frame, double shift) {
    std::normal_distribution<double> noise(0, 1);
    frame.plate.reset(kPlate);
    frame.depth_m.reset({48, 32});
    for (int y = 0; y < kPlate.height; ++y)
      for (int x = 0; x < kPlate.width; ++x) {
        const double wave = std::sin(0.4 * (x - shift)) * std::cos(0.3 * y);
        const auto v = static_cast<std::uint8_t>(std::lround(120 + 60 * wave + noise(random_)));
        frame.plate.at(x, y) = {v, v, v};
      }
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 48; ++x)
        frame.depth_m.at(x, y) = static_cast<float>(2 + 0.2 * std::sin(0.5 * (x - 0.5 * shift)) +
                                                    0.004 * noise(random_));
  }

  ManualClock& clock_;
  PanTiltAngles from_, to_;
  HostTime moved_{};
  std::mt19937 random_{7};
  int number_ = 0;
};

class Sweep : public ::testing::Test {
 protected:
  Sweep() {
    options_.views = {{0.5, 0.1}, {1.0, 0.1}, {1.0, -0.2}};
    options_.settings.view_frames = 3;
    options_.save = [this](std::span<const capture::Capture> frames, PanTiltAngles at,
                           std::span<const capture::BracketPlate>) {
      std::vector<HostTime> times;
      for (const capture::Capture& frame : frames) times.push_back(frame.mid_exposure);
      saved_.push_back({at, times});
      return save_fails_ ? Result<void>(Error{ErrorCode::kIo, "disk full"}) : Result<void>();
    };
  }
  Result<SweepReport> run() { return run_sweep(rig_, options_, stop_, clock_); }
  Error failed() {
    const auto done = run();
    EXPECT_FALSE(done);
    return done ? Error{} : done.error();
  }
  void expect_all_views() {
    ASSERT_EQ(saved_.size(), options_.views.size());
    for (std::size_t i = 0; i < saved_.size(); ++i) {
      EXPECT_NEAR(saved_[i].at.pan_rad, options_.views[i].pan_rad, 0.5 * kSweepStep_rad);
      EXPECT_NEAR(saved_[i].at.tilt_rad, options_.views[i].tilt_rad, 0.5 * kSweepStep_rad);
      EXPECT_EQ(saved_[i].times.size(), 3U);
    }
  }

  struct Saved {
    PanTiltAngles at;
    std::vector<HostTime> times;
  };
  ManualClock clock_;
  FakeSweepRig rig_{clock_};
  SweepOptions options_;
  std::atomic<bool> stop_ = false;
  std::vector<Saved> saved_;
  bool save_fails_ = false;
};

TEST_F(Sweep, TakesTheFramesThatWereExposedAfterTheUnitStood) {
  std::vector<std::size_t> done;
  Duration last_left{};
  options_.progress = [&](std::size_t views, Duration left) {
    done.push_back(views);
    last_left = left;
    if (views == 1) {
      EXPECT_GT(left, 1s);
    }
  };
  const HostTime begin = clock_.now();
  const auto report = run();
  ASSERT_TRUE(report) << report.error().context;
  expect_all_views();
  EXPECT_EQ(report->views, 3U);
  EXPECT_EQ(report->restarts, 0);
  EXPECT_EQ(done, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(last_left, Duration{});
  // The unit is at rest from 0.4 s on. The first saved frame begins after a frame that reported
  // this.
  EXPECT_GE(saved_[0].times[0] - 20ms, begin + 400ms);
  EXPECT_LT(saved_[0].times[0], begin + 500ms);
  EXPECT_EQ(saved_[0].times[2] - saved_[0].times[0], 80ms);
}

TEST_F(Sweep, APictureThatStillSwingsIsWaitedFor) {
  rig_.swing_px = 2;
  const HostTime begin = clock_.now();
  const auto report = run();
  ASSERT_TRUE(report) << report.error().context;
  expect_all_views();
  EXPECT_GT(report->restarts, 3);
  // 2 px fall to 0.1 px in three times the swing's 0.3 s.
  EXPECT_GT(saved_[0].times[0] - begin, 1s);
  EXPECT_LT(saved_[0].times[0] - begin, 3s);
}

TEST_F(Sweep, AUnitThatOvershootsIsWaitedFor) {
  rig_.overshoot_rad = 4 * kSweepStep_rad;
  const HostTime begin = clock_.now();
  ASSERT_TRUE(run());
  expect_all_views();
  EXPECT_GT(saved_[0].times[0] - begin, 660ms);
}

TEST_F(Sweep, LostFramesCostTime) {
  for (int number = 1; number < 400; ++number)
    if (number % 3 != 0) rig_.dropped.insert(number);
  ASSERT_TRUE(run());
  expect_all_views();
}

TEST_F(Sweep, AUnitThatGivesNoAnglesIsLost) {
  rig_.on_frame = [&](int number) { rig_.unit_lost = number > 40; };
  const Error error = failed();
  EXPECT_EQ(error.code, ErrorCode::kDevice);
  EXPECT_NE(error.context.find("unit is lost"), std::string::npos) << error.context;
  EXPECT_NE(error.context.find("view 3 of 3 (pan 57.3, tilt -11.5 deg)"), std::string::npos)
      << error.context;
  EXPECT_EQ(saved_.size(), 2U);
  EXPECT_EQ(rig_.halts, 0) << "it would not answer";
}

TEST_F(Sweep, GoesOnWithTheViewsThatAreMissing) {
  rig_.on_frame = [&](int number) { rig_.unit_lost = number > 20; };
  EXPECT_EQ(failed().code, ErrorCode::kDevice);
  ASSERT_EQ(saved_.size(), 1U);
  rig_.on_frame = {};
  rig_.unit_lost = false;
  rig_.targets.clear();
  options_.first = saved_.size();
  const auto report = run();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->views, 3U);
  EXPECT_EQ(rig_.targets.size(), 2U);
  expect_all_views();
}

TEST_F(Sweep, EndsBetweenFramesWhenItIsStopped) {
  rig_.on_frame = [&](int number) { stop_ = number == 20; };
  const auto report = run();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->stopped);
  EXPECT_EQ(rig_.halts, 1);
  EXPECT_EQ(report->views, 1U);
  EXPECT_EQ(saved_.size(), 1U);
}

TEST_F(Sweep, EachTimeoutHasItsName) {
  const auto expect = [&](ErrorCode code, const char* words) {
    rig_.home();
    const Error error = failed();
    EXPECT_EQ(error.code, code) << error.context;
    EXPECT_NE(error.context.find(words), std::string::npos) << error.context;
    EXPECT_EQ(error.context.find('\n'), std::string::npos);
  };
  rig_.stuck = true;
  expect(ErrorCode::kTimeout, "does not move for 5 s, 28.65 deg away");
  rig_.stuck = false;
  rig_.short_by_rad = 0.05;
  expect(ErrorCode::kTimeout, "has not come nearer for 5 s, 2.86 deg away");
  rig_.short_by_rad = 0;
  rig_.swing_px = 3, rig_.swing_time = 1000s;
  expect(ErrorCode::kTimeout, "picture does not settle (15 s)");
  rig_.swing_px = 0;
  rig_.frames_lost = true;
  expect(ErrorCode::kTimeout, "no frames that could be paired");
  rig_.frames_lost = false;
  rig_.refuses = true;
  expect(ErrorCode::kTimeout, "the pan-tilt unit was not moved: the unit does not answer");
  rig_.refuses = false;
  save_fails_ = true;
  expect(ErrorCode::kIo, "view 1 of 3");
}

TEST_F(Sweep, OneFrameAViewStillNeedsASecondOneThatAgrees) {
  options_.settings.view_frames = 1;
  rig_.swing_px = 2;
  ASSERT_TRUE(run());
  ASSERT_EQ(saved_.size(), 3U);
  EXPECT_EQ(saved_[0].times.size(), 1U);
  EXPECT_GT(saved_[0].times[0] - HostTime{}, 750ms);
}

}  // namespace
}  // namespace mixrig::live
