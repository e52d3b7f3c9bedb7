// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/quality.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/run/explain/explain.h"
#include "tests/support/box_source.h"

namespace mixrig::session {
namespace {

using scene::FocusRung;
using scene::KeyRung;
using scene::LightRung;
using scene::Rungs;

/// Time of a frame on a machine where each quality level has a cost.
double cost_ms(const Rungs& r) {
  return 10 + 4.0 * static_cast<int>(r.key) + 3.0 * static_cast<int>(r.light) +
         (r.focus == FocusRung::kFine ? 5 : 0);
}
Result<QualityChoice> choose(const Rungs& wanted, double budget_ms, bool focus = true,
                             bool objects = true) {
  return choose_rungs(wanted, focus, objects, budget_ms,
                      [](const Rungs& r) { return Result<double>(cost_ms(r)); });
}
constexpr Rungs kBest{KeyRung::kRefined, LightRung::kPeople, FocusRung::kFine};  // 29 ms

TEST(ChooseRungs, StayWhereTheyFit) {
  const auto choice = choose(kBest, 29);
  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->rungs, kBest);
  EXPECT_TRUE(choice->fits());
  EXPECT_EQ(choice->trials.size(), 1U) << "nothing else is measured";
}

TEST(ChooseRungs, AreLeftInOrderUntilTheyFit) {
  EXPECT_EQ(choose(kBest, 24)->rungs,
            (Rungs{KeyRung::kRefined, LightRung::kPeople, FocusRung::kFast}));
  EXPECT_EQ(choose(kBest, 21)->rungs,
            (Rungs{KeyRung::kRefined, LightRung::kShadows, FocusRung::kFast}));
  EXPECT_EQ(choose(kBest, 17)->rungs,
            (Rungs{KeyRung::kVotes, LightRung::kShadows, FocusRung::kFast}));
  EXPECT_EQ(choose(kBest, 16)->rungs,
            (Rungs{KeyRung::kVotes, LightRung::kPlain, FocusRung::kFast}));
  const auto least = choose(kBest, 5);
  EXPECT_EQ(least->rungs, (Rungs{KeyRung::kPlain, LightRung::kPlain, FocusRung::kFast}));
  EXPECT_FALSE(least->fits());
  EXPECT_DOUBLE_EQ(least->ms, 10);
  EXPECT_EQ(least->trials.size(), 6U);
}

TEST(ChooseRungs, WhatIsNotThereIsNotLeft) {
  const auto choice =
      choose({KeyRung::kVotes, LightRung::kShadows, FocusRung::kFine}, 1, false, false);
  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->rungs, (Rungs{KeyRung::kPlain, LightRung::kShadows, FocusRung::kFine}));
  EXPECT_EQ(choice->trials.size(), 2U);
}

TEST(ChooseRungs, AStepThatSavesNothingIsTakenBack) {
  const auto choice = choose_rungs(kBest, true, true, 15, [](const Rungs& r) -> Result<double> {
    return r.key == KeyRung::kRefined ? 20.0 : 14.0;  // focus and light cost nothing
  });
  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->rungs, (Rungs{KeyRung::kVotes, LightRung::kPeople, FocusRung::kFine}));
  EXPECT_TRUE(choice->fits());
  EXPECT_NE(to_text(*choice).find("taken back"), std::string::npos) << to_text(*choice);
}

TEST(ChooseRungs, AnErrorEndsIt) {
  const auto choice = choose_rungs(kBest, true, true, 15, [](const Rungs&) -> Result<double> {
    return Error{ErrorCode::kDevice, "lost"};
  });
  EXPECT_FALSE(choice);
}

TEST(PaintPeople, PutsTwoBeforeWhatIsThere) {
  capture::Capture capture;
  capture.depth_m.reset({100, 80}, 2.0F);
  capture.depth_m.at(32, 44) = 0;
  capture.plate.reset({200, 160}, {10, 20, 30});
  paint_people(capture);
  EXPECT_FLOAT_EQ(capture.depth_m.at(66, 44), 1.2F);
  EXPECT_FLOAT_EQ(capture.depth_m.at(32, 44), 1.8F) << "unknown";
  EXPECT_FLOAT_EQ(capture.depth_m.at(49, 44), 2.0F) << "between them";
  EXPECT_EQ(capture.plate.at(132, 88), (Rgb8{245, 235, 225}));
  EXPECT_EQ(capture.plate.at(2, 2), (Rgb8{10, 20, 30}));
}

class BudgetTest : public ::testing::Test {
 protected:
  BudgetTest() {
    session_.source = std::make_unique<test::BoxSource>(5, 12);
    session_.setup = *setup_of(session_.source->info(), std::nullopt);
    session_.backend = {render::Backend::kCpu, 1};
  }
  Session session_;
  SystemClock clock_;
};

TEST_F(BudgetTest, WithoutABudgetNothingIsMeasured) {
  const auto choice = follow_budget(session_, 1, clock_);
  ASSERT_TRUE(choice);
  EXPECT_FALSE(*choice);
}

TEST_F(BudgetTest, ALargeOneKeepsWhatTheSceneAsksFor) {
  session_.scene.quality.budget_ms = 1000;
  const auto choice = follow_budget(session_, 1, clock_);
  ASSERT_TRUE(choice && *choice);
  EXPECT_TRUE((*choice)->fits());
  EXPECT_TRUE(session_.setup.key.refine);
}

// Nothing is keyed here, so that no quality level is faster than another except by chance.
TEST_F(BudgetTest, ATinyOneIsNotReachedAndTheRunGoesOn) {
  session_.scene.quality.budget_ms = 1e-6;
  const auto out = explain(session_, 3, {}, clock_, {});
  ASSERT_TRUE(out) << out.error().context;
  ASSERT_TRUE(out->quality);
  EXPECT_FALSE(out->quality->fits());
  EXPECT_EQ(session_.setup.key.refine, out->quality->rungs.key == KeyRung::kRefined);
  EXPECT_NE(to_text(*out).find("not reached"), std::string::npos);
  EXPECT_EQ(to_json(*out)["quality"]["fits"], false);
}

}  // namespace
}  // namespace mixrig::session
