// SPDX-License-Identifier: Apache-2.0
// Whole sessions on fake devices: a master of 100 Hz, colour at 25 Hz, depth at 25 Hz, a slower
// camera; then one fault at a time.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include "host/capture/live/session/record.h"
#include "host/capture/take/segments/segments.h"
#include "tests/support/refusal.h"
#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

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
  EXPECT_EQ(without.size(), 20U) << "the others continued";
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
  EXPECT_LT(after.back().frames.tick, 130U) << "ticks start again";
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

class RecordedSession : public Session {
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
  /// Records while a second thread advances the clock.
  Result<RecordReport> record_now() {
    std::thread crank([&] {
      wait([&] { return trigger_->wait_for_start(starts_, 1ms); });
      for (int ticks = 0; !done_; ++ticks) {
        if (ticks == reset_at_) {
          trigger_->reset();
          clock_.advance(300ms);
          if (!trigger_->wait_for_start(2, 60s)) return;
        }
        tick();
        wait([&] { return session_->report().waiting_sets == 0; });
      }
    });
    auto report = record(*session_, config_, devices_, options_, stop_, clock_);
    done_ = true;
    crank.join();
    return report;
  }
  /// Another session, as after a restart of the program.
  void restart() {
    done_ = false, ticked_ = 0, ++starts_;
    session_.emplace(config_, devices_, clock_);
  }
  std::filesystem::path folder_;
  RecordOptions options_;
  int starts_ = 1;     ///< of the trigger, until the recording
  int reset_at_ = -1;  ///< tick at which the trigger is reset
  std::atomic<bool> stop_ = false;
};

TEST_F(RecordedSession, ATakeHoldsItsFramesAndTheirTicks) {
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

struct DayKind {
  take::StreamFormat format;
  Duration segment;
  double most_bytes;  ///< of growth, a frame
};

class RecordedDay : public RecordedSession, public ::testing::WithParamInterface<DayKind> {};

std::size_t heap_bytes() {
  const auto heap = ::mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

/// Waits until nothing changes the heap: encoders have up to half a second of frames before them,
/// and a new one may not have begun.
void settle_heap() {
  constexpr int kSame = 200, kMostTries = 10000;
  std::size_t before = 0;
  for (int same = 0, tries = 0; same < kSame && tries < kMostTries; ++tries) {
    const std::size_t bytes = heap_bytes();
    same = bytes == before ? same + 1 : 0;
    before = bytes;
    std::this_thread::sleep_for(1ms);
  }
}

/// 24 h have 2.16 million frames. What is in use on the heap is known to the byte; the least of
/// some frames leaves out what the muxers gather. Pictures: 3 MB in 24 h are 1.4 bytes a frame. One
/// take of Matroska: the muxers of colour and depth keep 32 bytes for every eighth frame, 17 MB in
/// 24 h. Segments: 1.6 KB each, which are 0.3 MB in 24 h where they are ten minutes long.
TEST_P(RecordedDay, GrowsByItsIndexAlone) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers have an allocator of their own";
#endif
  // Whole segments lie between the places, and an array that doubles grows in each span. What a
  // thread's cache of free blocks holds counts as used and may change once; what is lost with
  // frames is lost in both spans.
  constexpr std::array<int, 3> kPlaces{1050, 2550, 6300};
  constexpr int kFrames = 6500, kLooks = 190;
  options_.duration = kFrames * 40ms;
  options_.format = GetParam().format;
  options_.segments.length = GetParam().segment;
  std::array<std::size_t, 3> least{SIZE_MAX, SIZE_MAX, SIZE_MAX};
  int frames = 1;
  options_.progress = [&](double) {
    ++frames;
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
      const int since = frames - kPlaces[i];
      if (since < 0 || since >= kLooks) continue;
      if (since % 50 == 0) settle_heap();
      least[i] = std::min(least[i], heap_bytes());
    }
  };
  const auto report = record_now();
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_NEAR(report->frames, kFrames, 2);
  EXPECT_EQ(report->left_out, 0U);
  const auto growth = [&](std::size_t i) {
    return (static_cast<double>(least[i + 1]) - static_cast<double>(least[i])) /
           (kPlaces[i + 1] - kPlaces[i]);
  };
  EXPECT_LT(std::min(growth(0), growth(1)), GetParam().most_bytes);
  // The camera's own numbers are an independent count of what was sent.
  std::vector<std::filesystem::path> takes{folder_};
  if (GetParam().segment > Duration::zero()) takes.clear();
  for (const take::Segment& segment : take::segments_of(folder_)) takes.push_back(segment.path);
  std::string line;
  std::uint64_t rows = 0, first = 0, last = 0;
  for (const std::filesystem::path& take : takes) {
    std::ifstream ticks(take / "ticks.csv");
    while (std::getline(ticks, line)) {
      unsigned long long tick = 0, sequence = 0;
      if (std::sscanf(line.c_str(), "%*d,color,%llu,%llu", &tick, &sequence) != 2) continue;
      if (rows++ == 0) first = sequence;
      last = sequence;
    }
  }
  EXPECT_EQ(rows, static_cast<std::uint64_t>(report->frames));
  EXPECT_EQ(last - first + 1, rows) << "none is missing";
}

INSTANTIATE_TEST_SUITE_P(Formats, RecordedDay,
                         ::testing::Values(DayKind{take::StreamFormat::kPng, {}, 1.4},
                                           DayKind{take::StreamFormat::kMatroska, {}, 12},
                                           DayKind{take::StreamFormat::kMatroska, 10s, 9}));

TEST_F(RecordedSession, AResetOfTheTriggerBoardLeavesAReadableTake) {
  options_.duration = 3s;
  reset_at_ = 150;
  const auto report = record_now();
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_EQ(report->session.trigger_restarts, 1U);
  auto take = take::TakeReader::open(folder_);
  ASSERT_TRUE(take) << to_line(take.error());
  EXPECT_EQ(take->info().frames, report->frames);
  capture::Capture frame;
  for (int number = 1; number <= report->frames; ++number)
    ASSERT_TRUE(take->read(number, frame)) << number;
}

TEST_F(RecordedSession, EndsWholeBeforeTheDiskIsFull) {
  options_.least_free_bytes = 1000;
  options_.duration = 3600s;
  int asked = 0;
  options_.free_bytes = [&](const std::filesystem::path&) { return ++asked < 3 ? 2000U : 500U; };
  const auto report = record_now();
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_EQ(report->ended, "disk almost full");
  EXPECT_TRUE(take::TakeReader::open(folder_));
}

TEST_F(RecordedSession, ADiskThatIsFullAtTheStartIsSaid) {
  options_.least_free_bytes = 1000;
  options_.free_bytes = [&](const std::filesystem::path&) { return 999U; };
  EXPECT_TRUE(test::refused(record_now(), {"disk is almost full", "--keep-free"}, ErrorCode::kIo));
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

/// Segments of half a second, twice: what a restart of the service does.
TEST_F(RecordedSession, SegmentsFollowEachOtherWithoutALossAndAfterARestart) {
  options_.segments.length = 500ms;
  const auto first = record_now();
  ASSERT_TRUE(first) << to_line(first.error());
  EXPECT_NEAR(first->takes, 4, 1);
  auto take = take::TakeReader::open(folder_);
  ASSERT_TRUE(take) << to_line(take.error());
  EXPECT_EQ(take->info().frames, first->frames);
  capture::Capture frame;
  double last_s = -0.04;  // stamps are those of the trigger as the session estimates them
  for (int number = 1; number <= first->frames; ++number, last_s = frame.time_s) {
    ASSERT_TRUE(take->read(number, frame)) << number;
    EXPECT_NEAR(frame.time_s - last_s, 0.04, 5e-3) << number << ": none is missing";
  }
  restart();
  const auto again = record_now();
  ASSERT_TRUE(again) << to_line(again.error());
  take = take::TakeReader::open(folder_);
  ASSERT_TRUE(take) << to_line(take.error());
  EXPECT_EQ(take->info().frames, first->frames + again->frames);
  EXPECT_EQ(take->info().segments, first->takes + again->takes);
}

TEST_F(RecordedSession, TheOldestSegmentsAreDeletedOnlyWhereAsked) {
  options_.segments = {.length = 500ms, .most_bytes = 6 << 20};
  const auto ended = record_now();  // each take holds 4 MB of reserve while it is written
  ASSERT_TRUE(ended) << to_line(ended.error());
  EXPECT_EQ(ended->deleted, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "0001"));
  options_.segments.most_bytes = 1;
  restart();
  EXPECT_TRUE(test::refused(record_now(), {"may hold", "--drop-oldest"}, ErrorCode::kIo));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "0001"));
  options_.segments.drop_oldest = true, options_.segments.most_bytes = 100000;
  done_ = false;
  const auto went_on = record_now();
  ASSERT_TRUE(went_on) << to_line(went_on.error());
  EXPECT_GE(went_on->deleted, 4);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "0001"));
  EXPECT_EQ(went_on->ended, "duration");
  EXPECT_TRUE(take::TakeReader::open(folder_));
}

TEST_F(RecordedSession, StopLeavesAWholeTake) {
  options_.duration = 3600s;
  options_.progress = [this](double) { stop_ = true; };
  const auto report = record_now();
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_EQ(report->ended, "stopped");
  EXPECT_TRUE(take::TakeReader::open(folder_));
}

}  // namespace
}  // namespace mixrig::live
