// SPDX-License-Identifier: Apache-2.0
// Sessions whose host reads a trigger line: a check of the master, ticks while it reports none, and
// ticks without a master.
#include "host/capture/live/check/diagnose.h"
#include "tests/unit/live/session_rig.h"

namespace mixrig::live {
namespace {

class SessionEdges : public Session {
 protected:
  void SetUp() override {
    Session::SetUp();
    add_edges();
  }
  /// Every set has the tick that fired it, as determined by the counters of both cameras.
  std::vector<LiveSet> run_and_check(int ticks) {
    auto sets = run(ticks);
    for (const LiveSet& set : sets)
      for (const std::size_t stream : {0U, 2U}) {
        EXPECT_TRUE(set.frames.frames[stream].frame);
        if (!set.frames.frames[stream].frame) continue;
        EXPECT_EQ(set.frames.tick + first_, 4 * set.frames.frames[stream].frame->sequence);
      }
    return sets;
  }
  sync::EdgeCounts edges() { return session_->report().edges; }
  std::uint64_t first_ = 4;  ///< 4 * counter - tick
};

TEST_F(SessionEdges, MeasureTheErrorOfTheMastersTicks) {
  edge_late_ = 300us;
  ASSERT_TRUE(session_->start());
  run_and_check(400);
  EXPECT_EQ(edges().edges, 100U);
  EXPECT_NEAR(edges().offset_mean_ms, 0.3, 1e-3);
  EXPECT_NEAR(edges().offset_sd_ms, 0, 1e-3);
  edge_late_ = -2ms;
  run_and_check(4);
  EXPECT_NEAR(edges().offset_max_ms, -2, 1e-3);
  EXPECT_EQ(edges().lost + edges().doubled + edges().filled, 0U);
  session_->stop();
}

TEST_F(SessionEdges, ThatAreMissingOrDoubledAreCounted) {
  ASSERT_TRUE(session_->start());
  run_and_check(80);
  auto* seen = std::exchange(edges_, nullptr);
  run_and_check(12);
  edges_ = seen;
  run_and_check(8);
  edges_->edge();
  run_and_check(40);
  session_->stop();
  EXPECT_EQ(edges().lost, 3U);
  EXPECT_EQ(edges().doubled, 1U);
}

TEST_F(SessionEdges, ReplaceTicksWhileTheMasterIsSilent) {
  ASSERT_TRUE(session_->start());
  run_and_check(80);
  trigger_->set_silent(true);
  heard_ = false;
  EXPECT_EQ(run_and_check(400).size(), 100U) << "ten seconds without a tick from the master";
  EXPECT_GT(edges().filled, 80U);
  wait([&] { return session_->report().trigger_errors > 0; });
  trigger_->set_silent(false);
  heard_ = true;
  awaited_ = false;  // the session checks again after a while
  EXPECT_EQ(run_and_check(80).size(), 20U);
  awaited_ = true;
  const auto filled = edges().filled;
  EXPECT_EQ(run_and_check(80).size(), 20U);
  EXPECT_EQ(edges().filled, filled);
  session_->stop();
  EXPECT_EQ(session_->report().trigger_restarts, 0U);
}

TEST_F(SessionEdges, OfAResetTriggerArePairedWithNoOldTick) {
  ASSERT_TRUE(session_->start());
  run_and_check(84);
  trigger_->reset();
  clock_.advance(300ms);
  ASSERT_TRUE(trigger_->wait_for_start(2, 60s));
  first_ += 84;  // the cameras' counters continue, the ticks start at 0
  EXPECT_EQ(run_and_check(80).size(), 18U) << "two frames of colour to lock";
  run_and_check(320);
  session_->stop();
  EXPECT_NEAR(edges().offset_max_ms, 0, 1e-3);
  EXPECT_EQ(edges().filled + edges().lost, 0U);
}

class EdgesAlone : public SessionEdges {
 protected:
  void SetUp() override {
    SessionEdges::SetUp();
    outside_ = std::move(devices_.trigger);  // another program owns it
    ASSERT_TRUE(outside_->start());
    heard_ = false;
    session_.emplace(config_, devices_, clock_);
  }
  std::unique_ptr<device::TriggerMaster> outside_;
};

TEST_F(EdgesAlone, AreTheTicks) {
  ASSERT_TRUE(session_->start());
  const auto sets = run_and_check(400);
  EXPECT_EQ(sets.size(), 98U);
  int with_side = 0;
  for (const LiveSet& set : sets) with_side += set.frames.frames[1].frame ? 1 : 0;
  EXPECT_GT(with_side, 90) << "a camera on another line is paired by time";
  session_->stop();
  EXPECT_EQ(edges().filled, 100U);
}

TEST_F(EdgesAlone, StartAgainAfterASecondWithoutEdges) {
  ASSERT_TRUE(session_->start());
  run_and_check(400);
  clock_.advance(1500ms);
  ASSERT_TRUE(outside_->start());
  first_ += 400;
  const auto sets = run_and_check(80);
  EXPECT_EQ(sets.size(), 18U);
  session_->stop();
}

TEST(JudgeEdges, NamesWhatIsWrong) {
  const sync::EdgeCounts well{.edges = 75, .offset_mean_ms = 0.2, .offset_sd_ms = 0.05};
  EXPECT_EQ(judge_edges(well, 25, 3, true).verdict, Verdict::kPass);
  EXPECT_EQ(judge_edges({}, 25, 3, true).verdict, Verdict::kFail);
  auto edges = well;
  edges.offset_mean_ms = -2;
  EXPECT_EQ(judge_edges(edges, 25, 3, true).verdict, Verdict::kWarn);
  EXPECT_EQ(judge_edges(edges, 25, 3, false).verdict, Verdict::kPass) << "nothing to compare with";
  edges.offset_mean_ms = 6;
  EXPECT_EQ(judge_edges(edges, 25, 3, true).verdict, Verdict::kFail);
  edges = well;
  edges.lost = 10;
  EXPECT_EQ(judge_edges(edges, 25, 3, true).verdict, Verdict::kFail);
  EXPECT_EQ(judge_edges(well, 50, 3, true).verdict, Verdict::kFail) << "another divider";
}

}  // namespace
}  // namespace mixrig::live
