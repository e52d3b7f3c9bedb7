// SPDX-License-Identifier: Apache-2.0
// A fisheye with a rate and a trigger line of its own: live and in the take that is recorded from
// it, the same pictures with the same stamps, by one rule for repeated and missing ones.
#include <functional>
#include <thread>

#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/session/record.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

using capture::Stream;
using capture::StreamStatus;

constexpr std::uint64_t kFisheyeTicks = 10, kHeldTicks = 15;

/// Fired on every 10th tick, after the plates: those of a tick do not have its picture yet.
std::uint64_t newest_fisheye(std::uint64_t tick) {
  return (tick - 1) / kFisheyeTicks * kFisheyeTicks;
}

class Fisheye : public Session {
 protected:
  void SetUp() override {
    Session::SetUp();
    config_.file = "rig.toml";
    config_.cameras[1].name = "fisheye";
    config_.cameras[1].delay = 3ms;
  }
  Result<RecordReport> record_now(const std::function<void(std::uint64_t tick)>& before_tick) {
    std::thread crank([&] {
      if (!trigger_->wait_for_start(1, 20s)) return;
      for (std::uint64_t number = 0; !done_; ++number) {
        before_tick(number);
        tick();
        wait([&] { return session_->report().waiting_sets == 0; });
      }
    });
    RecordOptions options;
    options.out = folder_ / "take";
    options.format = take::StreamFormat::kPng;
    options.duration = 2s;
    options.least_free_bytes = 0;
    auto report = record(*session_, config_, devices_, options, stop_, clock_);
    done_ = true;
    crank.join();
    return report;
  }
  /// Holds a capture against the rule; pictures come up to tick `last`, and again from `again` on.
  void expect_by_rule(const capture::Capture& capture, std::uint64_t last, std::uint64_t again) {
    SCOPED_TRACE(capture.tick);
    std::uint64_t newest = newest_fisheye(capture.tick);
    if (newest > last && newest < again) newest = last / kFisheyeTicks * kFisheyeTicks;
    const std::uint64_t age = capture.tick - newest;
    const StreamStatus expected = newest != shown_    ? StreamStatus::kFresh
                                  : age <= kHeldTicks ? StreamStatus::kRepeated
                                                      : StreamStatus::kMissing;
    EXPECT_EQ(capture.status_of(Stream::kFisheye), expected);
    ++seen_[static_cast<std::size_t>(capture.status_of(Stream::kFisheye))];
    shown_ = newest;
    if (expected == StreamStatus::kMissing) {
      EXPECT_TRUE(capture.fisheye.empty());
      EXPECT_EQ(capture.fisheye_counter, 0U);
      return;
    }
    // The master's clock is not the host's, and known to 2 ms at first.
    EXPECT_NEAR(milliseconds(capture.mid_exposure - capture.fisheye_mid_exposure),
                10.0 * static_cast<double>(age) - 3, 2.5);
    ASSERT_EQ(capture.fisheye.size(), (Size{16, 8}));
    EXPECT_EQ(capture.fisheye.at(5, 3).g, capture.fisheye_counter & 255U) << "its own picture";
    if (expected == StreamStatus::kFresh && counter_ > 0) {
      EXPECT_EQ(capture.fisheye_counter, counter_ + 1);
    }
    counter_ = capture.fisheye_counter;
  }

  test::TemporaryFolder folder_;
  std::atomic<bool> stop_ = false;
  std::uint64_t shown_ = 0, counter_ = 0;
  std::array<int, 4> seen_{};  ///< captures by status
};

constexpr std::uint64_t kNever = 1'000'000;

TEST_F(Fisheye, IsRecordedAtItsOwnRateAndReadBackEqual) {
  const auto report = record_now([](std::uint64_t) {});
  ASSERT_TRUE(report) << to_line(report.error());
  auto take = take::TakeReader::open(folder_ / "take");
  ASSERT_TRUE(take) << to_line(take.error());
  ASSERT_TRUE(take->info().fisheye);
  EXPECT_EQ(take->info().fisheye->rate_hz, 10);
  EXPECT_NEAR(take->info().fisheye->count, 20, 3) << "2 s, and three until it is paired";
  capture::Capture frame;
  for (int number = 1; number <= take->info().frames; ++number) {
    ASSERT_TRUE(take->read(number, frame));
    if (shown_ == 0 && frame.status_of(Stream::kFisheye) == StreamStatus::kMissing) continue;
    expect_by_rule(frame, kNever, kNever);
  }
  EXPECT_EQ(seen_[static_cast<std::size_t>(StreamStatus::kFresh)], take->info().fisheye->count);
}

TEST_F(Fisheye, UnpluggedInMidTakeIsMissingInTheTakeAndComesBack) {
  constexpr std::uint64_t kOut = 85, kBack = 130;
  const auto report = record_now([this](std::uint64_t tick) {
    if (tick == kOut) side_->unplug();
    if (tick == kBack) side_->replug();
  });
  ASSERT_TRUE(report) << to_line(report.error());
  EXPECT_EQ(report->session.streams[1].name, "fisheye");
  EXPECT_EQ(report->session.streams[1].health.returns, 1U);
  auto take = take::TakeReader::open(folder_ / "take");
  ASSERT_TRUE(take) << to_line(take.error());
  capture::Capture frame;
  int missing = 0, fresh_after = 0;
  for (int number = 1; number <= take->info().frames; ++number) {
    ASSERT_TRUE(take->read(number, frame));
    const StreamStatus status = frame.status_of(Stream::kFisheye);
    if (frame.tick > 60 && frame.tick <= kBack) {
      if (shown_ == 0 && status != StreamStatus::kFresh) continue;
      expect_by_rule(frame, kOut, kNever);
      missing += status == StreamStatus::kMissing ? 1 : 0;
    }
    fresh_after += frame.tick > kBack && status == StreamStatus::kFresh ? 1 : 0;
  }
  EXPECT_EQ(missing, 9) << "plates of the ticks 96 to 128";
  EXPECT_GT(fresh_after, 2);
}

TEST_F(Fisheye, IsTheSameByTheSameRuleLive) {
  constexpr std::uint64_t kOut = 125;
  SetDecoder decoder(config_, devices_);
  ASSERT_TRUE(session_->start());
  capture::Capture capture;
  for (std::uint64_t number = 0; number < 180; ++number) {
    if (number == kOut) side_->unplug();
    tick();
    while (auto set = session_->next(0ms)) {
      ASSERT_TRUE(decoder.decode(*set, capture));
      if (shown_ == 0 && capture.status_of(Stream::kFisheye) == StreamStatus::kMissing) continue;
      expect_by_rule(capture, kOut, kNever);
    }
  }
  EXPECT_EQ(session_->report().streams[1].health.state, device::DeviceState::kLost);
  session_->stop();
  EXPECT_GT(seen_[static_cast<std::size_t>(StreamStatus::kFresh)], 5);
  EXPECT_GT(seen_[static_cast<std::size_t>(StreamStatus::kRepeated)], 10);
  EXPECT_EQ(seen_[static_cast<std::size_t>(StreamStatus::kMissing)], 11);
}

TEST_F(Fisheye, APictureThatCannotBeDecodedCostsNoPlate) {
  SetDecoder decoder(config_, devices_);
  ASSERT_TRUE(session_->start());
  std::optional<LiveSet> set;
  for (const LiveSet& one : run(100))
    if (one.frames.frames[1].frame) set = one;
  session_->stop();
  ASSERT_TRUE(set);
  auto broken = std::make_shared<device::Frame>(*set->frames.frames[1].frame);
  broken->format = device::PixelFormat::kMjpeg;  // its bytes are none
  set->frames.frames[1].frame = broken;
  capture::Capture capture;
  ASSERT_TRUE(decoder.decode(*set, capture));
  EXPECT_EQ(capture.status_of(Stream::kPlate), StreamStatus::kFresh);
  EXPECT_EQ(capture.status_of(Stream::kFisheye), StreamStatus::kMissing);
}

TEST_F(Fisheye, WithoutARateIsRefused) {
  config_.cameras[1].trigger_line = -1;
  auto info = fake_info(device::PixelFormat::kGray8);
  info.rate_hz = 0;
  devices_.cameras[1] = std::make_unique<fake::FakeCamera>(clock_, info);
  const auto refused = take_info(config_, devices_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_NE(refused.error().context.find("rate_hz"), std::string::npos);
  config_.cameras[1].request.rate_hz = 8;
  const auto info_of = take_info(config_, devices_);
  ASSERT_TRUE(info_of);
  EXPECT_EQ(info_of->fisheye_rate_hz, 8);
}

}  // namespace
}  // namespace mixrig::live
