// SPDX-License-Identifier: Apache-2.0
// `mixrig run` on takes with the judged look of the studio (docs/reference/studio.md), one per rig.
// Each has its own bounds, chosen on these seeds (tests/support/seeds.h).
#include <gtest/gtest.h>

#include "tests/e2e/command.h"
#include "tests/support/seeds.h"

namespace mixrig::test {
namespace {

struct Realistic {
  const char* rig;
  int seed;
  double least_key_iou, most_order_wrong_pct, most_light_rmse, most_depth_bad_pct;
};
void PrintTo(const Realistic& row, std::ostream* out) { *out << row.rig; }

class RealisticRun : public CommandTest, public ::testing::WithParamInterface<Realistic> {};

TEST_P(RealisticRun, MeetsItsBounds) {
  const Realistic& row = GetParam();
  ASSERT_EQ(studio("take", std::string("--scenario walk --rig ") + row.rig + " --seed " +
                               std::to_string(row.seed) + " --frames 10 --size 320x256"),
            0);
  ASSERT_EQ(mixrig("run " + path("take/scene.toml") + " --source take:" + path("take") + " --out " +
                   path("out") + " --backend cpu --format none --json " + path("report.json")),
            0);
  const auto error = report("report.json").at("error");
  EXPECT_GE(error.at("key_iou").get<double>(), row.least_key_iou);
  EXPECT_LE(error.at("order_wrong_pct").get<double>(), row.most_order_wrong_pct);
  EXPECT_LE(error.at("light_rmse").get<double>(), row.most_light_rmse);
  EXPECT_LE(error.at("depth_bad_pct").get<double>(), row.most_depth_bad_pct);
}

INSTANTIATE_TEST_SUITE_P(
    Rigs, RealisticRun,
    ::testing::Values(Realistic{"sr3000", seeds::kRealisticSr3000, 0.91, 3, 0.035, 40},
                      Realistic{"kinect2", seeds::kRealisticKinect2, 0.82, 8, 0.025, 12},
                      Realistic{"helios2", seeds::kRealisticHelios2, 0.94, 2.5, 0.025, 12}));

}  // namespace
}  // namespace mixrig::test
