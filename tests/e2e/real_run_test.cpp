// SPDX-License-Identifier: Apache-2.0
// The main job on a real recording (label data): people come and go in a room.
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
  const auto foreground_pct = report("report.json").at("foreground_pct").get<std::vector<double>>();
  ASSERT_EQ(foreground_pct.size(), 108U - 26U);
  for (int frame = 103; frame <= 108; ++frame)
    EXPECT_LE(foreground_pct[static_cast<std::size_t>(frame - 27)], 0.1)
        << "frame " << frame << " is empty";
  EXPECT_GE(*std::max_element(foreground_pct.begin(), foreground_pct.end()), 15.0);
}

}  // namespace
}  // namespace mixrig::test
