// SPDX-License-Identifier: Apache-2.0
// `mixrig run` on a real recording (label data) in which people enter and leave a room.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class RealRun : public CommandTest {
 protected:
  void SetUp() override {
    if (std::getenv("MIXRIG_DATA") == nullptr)
      GTEST_SKIP() << "needs recordings: set MIXRIG_DATA to the folder that holds them";
  }
  const std::string lab_ =
      std::string(std::getenv("MIXRIG_SOURCE") ? std::getenv("MIXRIG_SOURCE") : ".") +
      "/tests/data/lab_queue";
};

TEST_F(RealRun, EmptyFramesOfTheLabKeyNothingAndPeopleAreKeyed) {
  ASSERT_EQ(mixrig("scan --static " + lab_ + "/take.toml --frames 1-26 " + path("background")), 0);
  ASSERT_EQ(mixrig("run " + lab_ + "/scene.toml --source take:" + lab_ + "/take.toml --out " +
                   path("out") + " --backend cpu --format none --json " + path("report.json")),
            0);
  const std::vector<double> foreground_pct = column(path("out") + "/frames.csv", 4);
  ASSERT_EQ(foreground_pct.size(), 108U - 26U);
  EXPECT_EQ(report("report.json").at("frames"), 108 - 26);
  for (int frame = 103; frame <= 108; ++frame)
    EXPECT_LE(foreground_pct[static_cast<std::size_t>(frame - 27)], 0.1)
        << "frame " << frame << " is empty";
  EXPECT_GE(*std::max_element(foreground_pct.begin(), foreground_pct.end()), 15.0);
}

}  // namespace
}  // namespace mixrig::test
