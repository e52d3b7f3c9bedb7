// SPDX-License-Identifier: Apache-2.0
// `mixrig run` on studio takes: the report meets the bounds for held-out seeds
// (tests/support/seeds.h), and a scene without lamps exceeds the bound of the shadows.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/e2e/command.h"
#include "tests/e2e/shadows.h"
#include "tests/support/seeds.h"

namespace mixrig::test {
namespace {

constexpr const char* kFull = " --frames 8 --size 1280x1024";
constexpr const char* kSmall = " --frames 10 --size 640x512";

struct Row {
  const char* scenario;
  const char* rig;
  int seed;
  double least_key_iou;
  const char*
      take;  ///< either the full size, which the memory depends on, or more frames of a smaller one
};
/// ctest includes this text in the test's name; without it, that would be the bytes of the
/// pointers, which vary.
void PrintTo(const Row& row, std::ostream* out) { *out << row.scenario << '_' << row.rig; }

class StudioRun : public CommandTest, public ::testing::WithParamInterface<Row> {};

TEST_P(StudioRun, MeetsTheBoundsOfTheMainJob) {
  const Row& row = GetParam();
  ASSERT_EQ(studio("take", std::string("--plain --scenario ") + row.scenario + " --rig " + row.rig +
                               " --seed " + std::to_string(row.seed) + row.take),
            0);
  ASSERT_EQ(mixrig("run " + path("take/scene.toml") + " --source take:" + path("take") + " --out " +
                   path("out") + " --backend cpu --format none --json " + path("report.json")),
            0);
  const auto report = this->report("report.json");
  const auto& error = report.at("error");
  EXPECT_GE(error.at("key_iou").get<double>(), row.least_key_iou);
  EXPECT_LE(error.at("order_wrong_pct").get<double>(), 2.0);
  // Connected wrong pieces, a frame: who stands behind an object does not shine through it.
  const auto& scraps = error.at("scraps");
  EXPECT_LE(scraps.at("person_through_object").get<double>(), 0.2);
  EXPECT_LE(scraps.at("specks").get<double>(), 10);
  EXPECT_LE(error.at("light_rmse").get<double>(), 0.06);
  EXPECT_LE(error.at("light_shadow_rmse").get<double>(), kMostShadowRmse);
  EXPECT_LE(error.at("depth_bad_pct").get<double>(), 6.0);
#ifndef __SANITIZE_ADDRESS__  // its shadow memory counts too
  EXPECT_LE(report.at("rss_mb").get<double>(), 400.0);
#endif
  EXPECT_GT(report.at("foreground_pct").at("max").get<double>(), 1.0);
  const std::vector<double> foreground_pct = column(path("out") + "/frames.csv", 4);
  EXPECT_EQ(report.at("frames").get<int>(), foreground_pct.size());
  EXPECT_NEAR(report.at("foreground_pct").at("max").get<double>(),
              *std::max_element(foreground_pct.begin(), foreground_pct.end()), 0.01);

  ASSERT_EQ(mixrig("run " + with_lamps(path("take/scene.toml"), 0) +
                   " --source take:" + path("take") + " --backend cpu --json " + path("dark.json")),
            0);
  const auto dark = this->report("dark.json").at("error");
  EXPECT_GT(dark.at("light_shadow_rmse").get<double>(), kMostShadowRmse);
}

INSTANTIATE_TEST_SUITE_P(Seeds, StudioRun,
                         ::testing::Values(Row{"walk", "kinect2", seeds::kWalk, 0.95, kFull},
                                           Row{"talk", "kinect2", seeds::kTalk, 0.95, kSmall},
                                           Row{"walk", "sr3000", seeds::kCoarseWalk, 0.90,
                                               kSmall}));

}  // namespace
}  // namespace mixrig::test
