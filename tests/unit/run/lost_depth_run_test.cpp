// SPDX-License-Identifier: Apache-2.0
// A live run whose depth camera is lost for a while: it goes on, keys nobody, and keys again when
// depth is back. And files that an operator pauses.
#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include "host/run/loop/run.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/run/posed_source.h"

namespace mixrig::session {
namespace {

/// Phases of what the cameras see; the next phase begins when the composite has arrived.
enum class Phase { kEmpty, kPerson, kNoDepth, kPersonAgain, kOver };

class PhaseSink final : public output::CompositeSink {
 public:
  struct Seen {
    std::atomic<Phase> phase = Phase::kEmpty;
    std::atomic<int> without_depth = 0;
  };
  explicit PhaseSink(Seen& seen) : seen_(seen) {}
  std::string_view name() const override { return "phases"; }
  render::OutputMask wanted(int) const override {
    return render::kColor | render::kMatte | render::kState;  // in one pass
  }
  Result<void> write(const output::CompositePtr& composite) override {
    const bool missing =
        composite->capture->status_of(capture::Stream::kDepth) == capture::StreamStatus::kMissing;
    const bool keyed = composite->images.matte.at(32, 24) > 200;
    EXPECT_EQ(composite->images.color.at(32, 24), (Rgb8{128, 128, 128})) << "the plate";
    EXPECT_NE(composite->images.wanted & render::kState, 0U);
    EXPECT_FALSE(missing && keyed);
    const auto next = [&](Phase from, Phase to, bool when) {
      Phase expected = from;
      if (when) (void)seen_.phase.compare_exchange_strong(expected, to);
    };
    if (missing) ++seen_.without_depth;
    next(Phase::kPersonAgain, Phase::kOver, keyed && seen_.without_depth > 0);
    next(Phase::kNoDepth, Phase::kPersonAgain, missing && seen_.without_depth > 3);
    next(Phase::kPerson, Phase::kNoDepth, keyed);
    next(Phase::kEmpty, Phase::kPerson, !keyed);
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  Seen& seen_;
};

void describe(Phase phase, capture::Capture& capture) {
  capture.set_status(capture::Stream::kDepth, capture::StreamStatus::kFresh);
  if (phase == Phase::kNoDepth) {
    capture.depth_m = {};
    capture.set_status(capture::Stream::kDepth, capture::StreamStatus::kMissing);
  } else if (phase != Phase::kEmpty) {
    for (int y = 12; y < 36; ++y) std::fill_n(capture.depth_m.row(y) + 20, 24, 1.5F);
  }
}

TEST(LostDepthRun, GoesOnWithoutAKeyAndKeysAgain) {
  PhaseSink::Seen seen;
  Session session;
  session.source = std::make_unique<test::PosedSource>(
      5'000'000, [&](capture::Capture& capture) { describe(seen.phase, capture); }, true);
  session.scene.background.learn = FrameRange{1, 5};
  session.setup = *setup_of(session.source->info(), std::nullopt);
  session.backend = {render::Backend::kCpu, 1};
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  RunParts parts;
  parts.orders = &orders, parts.stop = &stop;
  parts.sinks.push_back(std::make_unique<PhaseSink>(seen));
  const SystemClock clock;
  std::thread end([&] {
    while (seen.phase != Phase::kOver && !stop) std::this_thread::yield();
    stop = true;
  });
  const auto report = run(session, {}, clock, {}, std::move(parts));
  stop = true;
  end.join();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(seen.phase, Phase::kOver);
  EXPECT_GT(seen.without_depth, 3);
  EXPECT_TRUE(orders.state().can_learn) << "a still background is watched in a live run";
  EXPECT_FALSE(orders.state().can_record) << "there is no folder";
}

TEST(PausedRun, WritesTheFramesThatWereRecorded) {
  const test::TemporaryFolder folder;
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  Session session;
  // A recording is read at most three frames ahead: 20 frames are paused from about the 8th on.
  session.source = std::make_unique<test::PosedSource>(20, [&](capture::Capture& capture) {
    if (capture.number != 8 && capture.number != 15) return;
    EXPECT_TRUE(orders.give(output::Record{capture.number == 15}));
  });
  session.setup = *setup_of(session.source->info(), std::nullopt);
  session.backend = {render::Backend::kCpu, 1};
  RunParts parts;
  parts.orders = &orders;
  RunOptions options;
  options.out = folder / "out";
  const SystemClock clock;
  const auto report = run(session, options, clock, {}, std::move(parts));
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_TRUE(orders.state().can_record);
  EXPECT_EQ(report->frames.frame_ms.count(), 20U);
  ASSERT_EQ(report->sinks[0].name, "files");
  EXPECT_GE(report->sinks[0].written, 10U);
  EXPECT_LE(report->sinks[0].written, 16U);
  std::ifstream table(folder / "out/frames.csv");
  int rows = -1;  // without the heading
  for (std::string row; std::getline(table, row);) ++rows;
  EXPECT_EQ(rows, static_cast<int>(report->sinks[0].written));
}

}  // namespace
}  // namespace mixrig::session
