// SPDX-License-Identifier: Apache-2.0
// People of a studio take on the floor, by the command. The bounds were chosen on seed 5: 40 mm
// RMS.
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class PlanRun : public CommandTest {};

TEST_F(PlanRun, PeopleOfATakeAreFollowedOnTheFloor) {
  ASSERT_EQ(studio("take",
                   "--scenario walk --rig kinect2 --seed 5 --people 2 --frames 75 --plain "
                   "--size 160x128"),
            0);
  ASSERT_EQ(mixrig("plan " + path("take/scene.toml") + " --source take:" + path("take") + " " +
                   path("out") + " --suggest 3 --json " + path("plan.json")),
            0);
  const nlohmann::json plan = report("plan.json");
  EXPECT_EQ(plan["frames"], 50);
  ASSERT_EQ(plan["people"].size(), 2U);
  for (const nlohmann::json& person : plan["people"]) {
    EXPECT_GT(person["height_m"], 1.2);
    EXPECT_LT(person["height_m"], 1.95);
  }
  EXPECT_LT(plan["error"]["rms_mm"], 60);
  EXPECT_LT(plan["error"]["p95_mm"], 120);
  EXPECT_EQ(plan["swaps"], 0);
  EXPECT_EQ(plan["error"]["missed_pct"], 0);
  EXPECT_GT(plan["free_m2"], 2);
  EXPECT_LT(plan["open_m2"], plan["free_m2"]);
  double dwelt_s = 0;
  for (const nlohmann::json& row : plan["dwell"]["time_s"])
    for (const nlohmann::json& time_s : row) dwelt_s += time_s.get<double>();
  EXPECT_NEAR(dwelt_s, 2 * 1.8, 0.4);  // two people for two seconds, minus the first frames
  ASSERT_FALSE(plan["places"].empty());
  EXPECT_GE(plan["places"][0]["path_m"], 0.35);
  nlohmann::json kept = plan;  // main adds what it says last
  for (const char* key : {"out", "next"}) kept.erase(key);
  EXPECT_EQ(report("out/report.json"), kept);
  for (const char* file : {"people.csv", "plan.png", "dwell.png", "picture.png", "paths.glb"})
    EXPECT_TRUE(std::filesystem::exists(path("out/" + std::string(file)))) << file;
  const std::vector<double> times = column(path("out/people.csv"), 1);
  ASSERT_FALSE(times.empty());
  EXPECT_GE(times.front(), 1.0);  // nobody is in the empty frames
}

}  // namespace
}  // namespace mixrig::test
