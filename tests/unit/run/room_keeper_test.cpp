// SPDX-License-Identifier: Apache-2.0
// A box is put before the wall while a run goes on, and becomes background.
#include "host/run/watchers/room_keeper.h"

#include <atomic>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/room/background/static_background.h"
#include "host/run/loop/run.h"
#include "tests/support/box_source.h"

namespace mixrig::session {
namespace {
namespace fs = std::filesystem;

constexpr int kKeptEmpty = 5, kKeptFrames = 190;
constexpr double kSettle_s = 2;

/// 25 frames a second; the box may come later than the first frame after the empty ones.
class TimedBox final : public capture::CaptureSource {
 public:
  explicit TimedBox(bool sways) : sways_(sways) {}
  const capture::SourceInfo& info() const override { return box_.info(); }
  Result<bool> read(int number, capture::Capture& frame) override {
    MIXRIG_ASSIGN(const bool there, box_.read(number, frame));
    frame.time_s = number / 25.0;
    // Sways like a standing person.
    const float sway_m = sways_ && (number / 10) % 2 == 0 ? 0.03F : 0.0F;
    for (int y = 0; y < frame.depth_m.height(); ++y)
      for (int x = 0; x < frame.depth_m.width(); ++x)
        if (frame.depth_m.row(y)[x] < 2.5F) frame.depth_m.row(y)[x] += sway_m;
    return there;
  }
  Result<void> read_truth(int number, capture::Truth& truth) override {
    return box_.read_truth(number, truth);
  }

 private:
  const bool sways_;
  test::BoxSource box_{kKeptEmpty, kKeptFrames};
};

/// Keeps the share of foreground, and asks for the changes to be accepted at a frame.
class Foreground final : public output::CompositeSink {
 public:
  Foreground(std::vector<double>& pct, output::RunOrders& orders, int asks_at)
      : pct_(pct), orders_(orders), asks_at_(asks_at) {}
  std::string_view name() const override { return "foreground"; }
  render::OutputMask wanted(int) const override { return render::kMatte; }
  Result<void> write(const output::CompositePtr& composite) override {
    pct_.push_back(composite->foreground_pct);
    if (composite->capture->number != asks_at_) return {};
    return orders_.give(output::LearnChanges{});
  }
  Result<void> finish() override { return {}; }

 private:
  std::vector<double>& pct_;
  output::RunOrders& orders_;
  const int asks_at_;
};

class RoomKeeperTest : public ::testing::TestWithParam<render::Backend> {
 protected:
  RoomKeeperTest() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-keep-XXXXXX").string();
    root_ = mkdtemp(pattern.data());
    options_.changes.watch = model::watch_options(kSettle_s);
    options_.watch_room = true;
  }
  ~RoomKeeperTest() override { fs::remove_all(root_); }

  RunReport run_it(bool sways = false, int asks_at = 0) {
    Session session;
    session.source = std::make_unique<TimedBox>(sways);
    session.scene.background.learn = {1, kKeptEmpty};
    session.setup = *setup_of(session.source->info(), std::nullopt);
    session.backend = {GetParam(), 1};
    parts_.sinks.push_back(std::make_unique<Foreground>(pct_, orders_, asks_at));
    parts_.orders = &orders_;
    const SystemClock clock;
    auto report = run(session, options_, clock, {}, std::move(parts_));
    EXPECT_TRUE(report) << report.error().context;
    return report ? std::move(*report) : RunReport{};
  }
  /// Frame after the empty ones, from 0 on.
  double pct(int frame) const { return pct_.at(static_cast<std::size_t>(frame)); }

  static constexpr double kBox_pct =
      100.0 * test::BoxSource::kSide * test::BoxSource::kSide / (64 * 48);
  fs::path root_;
  RunOptions options_;
  RunParts parts_;
  std::atomic<bool> stop_ = false;
  output::RunOrders orders_{stop_};
  std::vector<double> pct_;
};

/// Cases that do not depend on the back end.
class RoomKeeperOnCpu : public RoomKeeperTest {};

TEST_P(RoomKeeperTest, WhatIsAcceptedIsBackgroundAndNoFrameIsLost) {
  options_.changes.accept_all = true;
  options_.save_room = root_ / "after";
  const RunReport report = run_it();
  ASSERT_TRUE(report.compositor.room_changes);
  ASSERT_EQ(report.compositor.room_changes->changes.size(), 1U);
  const model::RoomChange& change = report.compositor.room_changes->changes[0];
  EXPECT_EQ(change.kind, model::ChangeKind::kAppeared);
  EXPECT_TRUE(change.accepted);
  EXPECT_NEAR(change.center_m.z(), 2, 0.04) << "identity pose: z is ahead";
  EXPECT_NEAR(change.size_m.x(), 0.8, 0.15);
  EXPECT_EQ(report.compositor.room_changes->accepted, 1);
  ASSERT_EQ(pct_.size(), static_cast<std::size_t>(kKeptFrames - kKeptEmpty));
  EXPECT_NEAR(pct(0), kBox_pct, 1.0);
  EXPECT_NEAR(pct(60), kBox_pct, 1.0) << "certain, not yet learned";
  EXPECT_LT(pct(kKeptFrames - kKeptEmpty - 1), 0.1 * kBox_pct);
  const auto saved = model::load_static_background(root_ / "after");
  ASSERT_TRUE(saved) << saved.error().context;
  EXPECT_NEAR(saved->depth_m.at(32, 24), 2, 0.005F);
  EXPECT_NEAR(saved->depth_m.at(4, 4), 3, 0.005F) << "as it was";
  EXPECT_GT(saved->color.at(32, 24).r, 3 * saved->color.at(32, 24).g);
}

TEST_P(RoomKeeperOnCpu, WithoutAnOrderItIsOnlyTold) {
  options_.save_room = root_ / "after";
  const RunReport report = run_it();
  ASSERT_TRUE(report.compositor.room_changes);
  ASSERT_EQ(report.compositor.room_changes->changes.size(), 1U);
  EXPECT_FALSE(report.compositor.room_changes->changes[0].accepted);
  EXPECT_NEAR(pct(kKeptFrames - kKeptEmpty - 1), kBox_pct, 1.0);
  EXPECT_FALSE(fs::exists(root_ / "after")) << "nothing to save";
  const nlohmann::json json = to_json(report).at("room_changes");
  EXPECT_EQ(json.at("found")[0].at("kind"), "appeared");
  EXPECT_EQ(json.at("accepted"), 0);
  EXPECT_NE(to_table(report).find("appeared at"), std::string::npos);
}

TEST_P(RoomKeeperOnCpu, AnOrderWhileItRunsIsFollowed) {
  const RunReport report = run_it(false, 100);
  ASSERT_TRUE(report.compositor.room_changes);
  EXPECT_EQ(report.compositor.room_changes->accepted, 1);
  EXPECT_NEAR(pct(94), kBox_pct, 1.0) << "frame 99";
  EXPECT_LT(pct(kKeptFrames - kKeptEmpty - 1), 0.1 * kBox_pct);
}

TEST_P(RoomKeeperOnCpu, AnOrderBeforeAnythingIsFoundIsNone) {
  const RunReport report = run_it(false, 10);
  EXPECT_EQ(report.compositor.room_changes->accepted, 0);
}

TEST_P(RoomKeeperTest, AScanLearnsAllOfTheRoomAnew) {
  ASSERT_TRUE(orders_.give(output::LearnRoom{true}));
  options_.save_room = root_ / "after";
  const RunReport report = run_it();
  EXPECT_EQ(orders_.state().scan_left, 0);
  EXPECT_NEAR(pct(60), kBox_pct, 1.0) << "still looking";
  EXPECT_LT(pct(kKeptFrames - kKeptEmpty - 1), 0.1 * kBox_pct);
  const auto saved = model::load_static_background(root_ / "after");
  ASSERT_TRUE(saved) << saved.error().context;
  EXPECT_NEAR(saved->depth_m.at(32, 24), 2, 0.005F);
  EXPECT_NEAR(saved->depth_m.at(4, 4), 3, 0.005F);
}

/// Ends a scan after some frames.
class EndsScan final : public output::CompositeSink {
 public:
  explicit EndsScan(output::RunOrders& orders) : orders_(orders) {}
  std::string_view name() const override { return "ends"; }
  render::OutputMask wanted(int) const override { return render::kMatte; }
  Result<void> write(const output::CompositePtr& composite) override {
    if (composite->capture->number != 60) return {};
    return orders_.give(output::LearnRoom{false});
  }
  Result<void> finish() override { return {}; }

 private:
  output::RunOrders& orders_;
};

TEST_P(RoomKeeperOnCpu, AScanThatIsEndedChangesNothing) {
  ASSERT_TRUE(orders_.give(output::LearnRoom{true}));
  EXPECT_EQ(orders_.state().scan_left, output::kScanLooks) << "as it was asked for";
  parts_.sinks.push_back(std::make_unique<EndsScan>(orders_));
  (void)run_it();
  EXPECT_EQ(orders_.state().scan_left, 0);
  EXPECT_NEAR(pct(kKeptFrames - kKeptEmpty - 1), kBox_pct, 1.0);
}

TEST_P(RoomKeeperOnCpu, WhatSwaysIsNotAccepted) {
  options_.changes.accept_all = true;
  const RunReport report = run_it(true);
  EXPECT_TRUE(report.compositor.room_changes->changes.empty())
      << to_json(report).at("room_changes").dump();
  EXPECT_NEAR(pct(kKeptFrames - kKeptEmpty - 1), kBox_pct, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Cpu, RoomKeeperOnCpu, ::testing::Values(render::Backend::kCpu));
INSTANTIATE_TEST_SUITE_P(BackEnds, RoomKeeperTest,
                         ::testing::Values(render::Backend::kCpu, render::Backend::kGles),
                         [](const auto& backend) {
                           return backend.param == render::Backend::kCpu ? "cpu" : "gles";
                         });

}  // namespace
}  // namespace mixrig::session
