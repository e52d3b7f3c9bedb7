// SPDX-License-Identifier: Apache-2.0
// `mixrig run` on a studio take whose camera moves: the background follows it.
#include <gtest/gtest.h>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class MovingRun : public CommandTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(MovingRun, KeysAgainstTheBackgroundOfEachPose) {
  ASSERT_EQ(mixrig("studio " + path("take") + " --scenario " + GetParam() +
                   " --rig kinect2 --seed 31 --frames 30 --size 640x512"),
            0);
  ASSERT_EQ(mixrig("run " + path("take/scene.toml") + " --source take:" + path("take") + " --out " +
                   path("out") + " --backend cpu --format none --json " + path("report.json")),
            0);
  const auto report = this->report("report.json");
  EXPECT_GE(report.at("error").at("key_iou").get<double>(), 0.92);
  EXPECT_LE(report.at("error").at("order_wrong_pct").get<double>(), 2.0);
  EXPECT_GT(report.at("stage_ms").at("background").at("p50").get<double>(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, MovingRun, ::testing::Values("pan", "handheld"));

}  // namespace
}  // namespace mixrig::test
