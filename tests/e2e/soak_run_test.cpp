// SPDX-License-Identifier: Apache-2.0
// `mixrig bench --suite soak`: a short take is played for long by a clock that runs faster. Lost
// frames are allowed on a machine under load; frames that are lost without a reason are not.
#include <gtest/gtest.h>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class SoakRun : public CommandTest {};

TEST_F(SoakRun, AccountsForEveryFrameAndDoesNotGrow) {
  ASSERT_EQ(
      studio("take", "--plain --scenario walk --rig sr3000 --seed 7 --size 160x128 --frames 20"),
      0);
  ASSERT_EQ(mixrig("bench --suite soak --take " + path("take") + " --out " + path("soak") +
                   " --minutes 2 --speed 8 --json " + path("soak.json")),
            0);
  const auto soak = report("soak.json");
  const auto frames = soak.at("frames");
  EXPECT_EQ(frames.at("exposed").get<int>() + frames.at("overrun").get<int>(), 2 * 60 * 25);
  EXPECT_GT(frames.at("shown").get<int>(), 0);
  EXPECT_LE(frames.at("unexplained").get<int>(), 0);
  EXPECT_GE(soak.at("real_s").get<double>(), 14.9);
  EXPECT_LT(soak.at("growth_mb").get<double>(), 10);
}

TEST_F(SoakRun, IsRefusedWithoutATake) {
  EXPECT_NE(refusal("bench --suite soak").find("--take"), std::string::npos);
  EXPECT_NE(refusal("bench --suite marker --rig " + path("none.toml") + " --line 3").find("none"),
            std::string::npos);
}

}  // namespace
}  // namespace mixrig::test
