// SPDX-License-Identifier: Apache-2.0
// Whole sessions on fake devices: a master of 100 Hz, colour at 25 Hz, depth at 25 Hz, a slower
// camera; then one fault at a time.
#include "host/rig/live_session.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "hal/fake/fake_camera.h"
#include "hal/fake/fake_trigger.h"
#include "host/rig/record.h"

namespace mixrig::rig {
namespace {

using namespace std::chrono_literals;

/// Time that only the test moves, readable from every thread.
class TestClock final : public Clock {
 public:
  HostTime now() const override { return HostTime(Duration(now_ns_.load())); }
  void sleep_until(HostTime) override { std::this_thread::yield(); }
  void advance(Duration by) { now_ns_ += by.count(); }

 private:
  std::atomic<std::int64_t> now_ns_{1'000'000'000};
};

device::CameraInfo camera_info(device::PixelFormat format) {
  return {.uri = "fake:",
          .model = "fake",
          .size = {16, 8},
          .format = format,
          .rate_hz = 25,
          .stamp_clock = device::StampClock::kHost};
}

class Session : public ::testing::Test {
 protected:
  void SetUp() override {
    config_.name = "fake";
    config_.trigger_uri = "fake:trigger";
    config_.lines = {{0, {.divider = 4, .phase = 0ms, .width = 1ms}},
                     {1, {.divider = 10, .phase = 0ms, .width = 1ms}}};
    const auto camera = [](const char* name, int line) {
      CameraConfig c;
      c.name = name;
      c.uri = "fake:";
      c.trigger_line = line;
      return c;
    };
    config_.cameras = {camera("color", 0), camera("side", 1)};
    config_.depth = camera("depth", 0);
    color_ = add(device::PixelFormat::kRgb8);
    side_ = add(device::PixelFormat::kGray8);
    auto depth =
        std::make_unique<fake::FakeCamera>(clock_, camera_info(device::PixelFormat::kDepth16), 256);
    depth_ = depth.get();
    devices_.depth = device::as_depth_camera(std::move(depth), {});
    auto trigger = std::make_unique<fake::FakeTrigger>(clock_);
    trigger_ = trigger.get();
    devices_.trigger = std::move(trigger);
    session_.emplace(config_, devices_, clock_);
  }
  fake::FakeCamera* add(device::PixelFormat format) {
    devices_.cameras.push_back(
        std::make_unique<fake::FakeCamera>(clock_, camera_info(format), 256));
    return static_cast<fake::FakeCamera*>(devices_.cameras.back().get());
  }
  /// Ten milliseconds of the rig. Returns when the pairing thread has taken all that happened.
  void tick() {
    clock_.advance(10ms);
    const std::uint64_t number = trigger_->tick();
    ++ticked_;
    wait([&] { return session_->report().ticks >= ticked_; });
    if (number % 4 == 0) {
      color_->emit();
      depth_->emit();
    }
    if (number % 10 == 0) side_->emit();
    wait([&] { return every_frame_was_taken(); });
  }
  bool every_frame_was_taken() const {
    const SessionReport report = session_->report();
    return std::all_of(report.streams.begin(), report.streams.end(), [](const StreamReport& s) {
      const auto& taken = s.pairing.by_status;
      return std::accumulate(taken.begin(), taken.end(), std::uint64_t{0}) == s.health.frames;
    });
  }
  /// Nothing here depends on speed: the limit only ends a test that would hang.
  template <typename Condition>
  void wait(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (!done_ && !condition()) {
      if (std::chrono::steady_clock::now() > end) {
        ADD_FAILURE() << "the session makes no progress";
        done_ = true;
        return;
      }
      std::this_thread::yield();
    }
  }
  /// Sets out of `ticks` ticks; a tick's sets are in the queue when tick() returns.
  std::vector<LiveSet> run(int ticks) {
    std::vector<LiveSet> sets;
    for (int i = 0; i < ticks; ++i) {
      tick();
      while (auto set = session_->next(0ms)) sets.push_back(*std::move(set));
    }
    return sets;
  }

  TestClock clock_;
  RigConfig config_;
  Devices devices_;
  fake::FakeCamera *color_ = nullptr, *side_ = nullptr, *depth_ = nullptr;
  fake::FakeTrigger* trigger_ = nullptr;
  std::uint64_t ticked_ = 0;
  std::atomic<bool> done_ = false;  ///< nobody listens any more
  std::optional<LiveSession> session_;
};

TEST_F(Session, EveryFrameIsPairedToTheTickThatFiredIt) {
  ASSERT_TRUE(session_->start());
  const auto sets = run(400);
  session_->stop();
  EXPECT_EQ(sets.size(), 98U) << "100 frames of colour, two of them to lock";
  for (const LiveSet& set : sets) {
    EXPECT_EQ(set.frames.tick % 4, 0U);
    // Colour and depth fire on ticks 0, 4, 8, ...: counter k belongs to tick 4 (k - 1).
    EXPECT_EQ(set.frames.frames[0].frame->sequence, set.frames.tick / 4 + 1);
    ASSERT_TRUE(set.frames.frames[2].frame);
    EXPECT_EQ(set.frames.frames[2].frame->sequence, set.frames.tick / 4 + 1);
    // The slower camera's last frame, once it has locked.
    if (set.frames.tick < 24) continue;
    ASSERT_TRUE(set.frames.frames[1].frame);
    EXPECT_EQ(set.frames.frames[1].frame->sequence, (set.frames.tick - 1) / 10 + 1);
  }
  const SessionReport report = session_->report();
  EXPECT_EQ(report.dropped_events, 0U);
  EXPECT_EQ(report.dropped_sets, 0U);
  EXPECT_EQ(report.streams[0].pairing.of(sync::PairStatus::kLocking), 2U);
  EXPECT_EQ(report.streams[0].pairing.relocks, 0U);
}

TEST_F(Session, ACameraUnpluggedAndBackCostsItsOwnFramesOnly) {
  ASSERT_TRUE(session_->start());
  run(80);
  side_->unplug();
  const auto without = run(80);
  EXPECT_EQ(without.size(), 20U) << "the others went on";
  side_->replug();
  const auto after = run(120);
  bool back = false;
  for (const LiveSet& set : after) back = back || set.frames.frames[1].frame != nullptr;
  EXPECT_TRUE(back);
  EXPECT_EQ(session_->report().streams[1].health.returns, 1U);
  session_->stop();
}

TEST_F(Session, AResetOfTheTriggerBoardIsNoticedAndTheRigGoesOn) {
  ASSERT_TRUE(session_->start());
  run(80);
  trigger_->reset();
  clock_.advance(300ms);
  ASSERT_TRUE(trigger_->wait_for_start(2, 20s)) << "the session starts it again";
  const auto after = run(120);
  session_->stop();
  EXPECT_EQ(session_->report().trigger_restarts, 1U);
  ASSERT_GE(after.size(), 20U);
  EXPECT_LT(after.back().frames.tick, 130U) << "ticks count anew";
}

TEST_F(Session, AConsumerThatSleepsLosesTheOldestAndTheyAreCounted) {
  ASSERT_TRUE(session_->start());
  for (int i = 0; i < 200; ++i) tick();
  EXPECT_GE(session_->report().dropped_sets, 40U);
  const auto set = session_->next(0ms);
  ASSERT_TRUE(set);
  EXPECT_GT(set->frames.tick, 150U);
  session_->stop();
}

TEST_F(Session, ADeviceThatDoesNotStartStopsTheOthersAgain) {
  depth_->fail_next_start({ErrorCode::kDevice, "fake: no power"});
  const auto started = session_->start();
  ASSERT_FALSE(started);
  EXPECT_EQ(color_->health().state, device::DeviceState::kStopped);
  ASSERT_TRUE(session_->start());
  session_->stop();
}

class Recording : public Session {
 protected:
  void SetUp() override {
    Session::SetUp();
    folder_ =
        std::filesystem::temp_directory_path() / ("mixrig_record_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    options_.out = folder_;
    options_.format = take::StreamFormat::kPng;
    options_.duration = 2s;
    options_.least_free_bytes = 0;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  /// Records while a second thread turns the crank.
  Result<RecordReport> record_now() {
    std::thread crank([&] {
      if (!trigger_->wait_for_start(1, 20s)) return;
      while (!done_) {
        tick();
        wait([&] { return session_->report().waiting_sets == 0; });
      }
    });
    auto report = record(*session_, config_, devices_, options_, stop_, clock_);
    done_ = true;
    crank.join();
    return report;
  }
  std::filesystem::path folder_;
  RecordOptions options_;
  std::atomic<bool> stop_ = false;
};

TEST_F(Recording, ATakeHoldsItsFramesAndTheirTicks) {
  const auto report = record_now();
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_EQ(report->ended, "duration");
  EXPECT_NEAR(report->frames, 50, 2) << "2 s at 25 Hz";
  EXPECT_EQ(report->session.dropped_sets, 0U);
  auto take = take::TakeReader::open(folder_);
  ASSERT_TRUE(take) << to_line(take.error());
  EXPECT_EQ(take->info().frames, report->frames);
  std::ifstream ticks(folder_ / "ticks.csv");
  std::string line;
  std::getline(ticks, line);
  int rows = 0;
  while (std::getline(ticks, line))
    if (line.find(",color,") != std::string::npos) ++rows;
  EXPECT_EQ(rows, report->frames);
}

TEST_F(Recording, EndsWholeBeforeTheDiskIsFull) {
  options_.least_free_bytes = 1000;
  options_.duration = 3600s;
  int asked = 0;
  options_.free_bytes = [&](const std::filesystem::path&) { return ++asked < 3 ? 2000U : 500U; };
  const auto report = record_now();
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_EQ(report->ended, "disk almost full");
  EXPECT_TRUE(take::TakeReader::open(folder_));
}

TEST_F(Recording, StopLeavesAWholeTake) {
  options_.duration = 3600s;
  options_.progress = [this](double) { stop_ = true; };
  const auto report = record_now();
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_EQ(report->ended, "stopped");
  EXPECT_TRUE(take::TakeReader::open(folder_));
}

}  // namespace
}  // namespace mixrig::rig
