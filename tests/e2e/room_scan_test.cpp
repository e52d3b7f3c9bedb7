// SPDX-License-Identifier: Apache-2.0
// A recorded sweep goes through `mixrig scan --take`; the result is compared with the room of the
// studio. The bounds were chosen on seeds 5 and 6 (median 1.4 mm, 95 % within 13.7 mm); the test
// uses seed 31.
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class RoomScan : public CommandTest {
 protected:
  nlohmann::json scanned(const std::string& sweep, const std::string& options,
                         const std::string& look = "--plain") {
    EXPECT_EQ(studio("take", "--scenario sweep --size 64x48 " + look + " " + sweep), 0);
    EXPECT_EQ(mixrig("scan --take " + path("take") + " --calibration " +
                     path("take/truth/calibration.toml") + " " + path("room") + " --evaluate " +
                     options + " --json " + path("room.json")),
              0);
    return report("room.json");
  }
};

TEST_F(RoomScan, HoldsTheFarWallsOfASmallField) {
  const auto report =
      scanned("--rig sr3000 --seed 31 --field 80x60 --view-frames 2", "--modulation 20");
  EXPECT_FALSE(report.at("bounced_light").at("removed").get<bool>()) << "no light bounces";
  EXPECT_EQ(report.at("views").get<int>(), 6);
  EXPECT_GT(report.at("measured_pct").get<double>(), 99.0);
  EXPECT_EQ(report.at("fill_pct").get<double>(), 100.0);
  const auto errors = report.at("evaluate");
  EXPECT_LT(errors.at("surface").at("p50_mm").get<double>(), 2.0);
  EXPECT_LT(errors.at("surface").at("p95_mm").get<double>(), 16.0);
  for (const char* key : {"mean_mm", "max_mm", "p95_mm"})
    for (const char* axis : {"width", "depth", "height"})
      EXPECT_TRUE(errors.at(key).at(axis).is_number()) << key << ' ' << axis;
  EXPECT_GT(report.at("triangles").get<int>(), 100);
  EXPECT_LT(2 * report.at("triangles").get<int>(), report.at("triangles_raw").get<int>());
  for (const char* file : {"manifest.toml", "room.exr", "room.glb", "color.png", "distance.png"})
    EXPECT_TRUE(std::filesystem::exists(path("room/" + std::string(file)))) << file;
}

/// Without it the surface is off by 17.4 mm in the median.
TEST_F(RoomScan, LightBetweenWallsIsTakenOut) {
  const auto report = scanned("--rig sr3000 --seed 31 --field 180x60 --view-frames 2",
                              "--modulation 20", "--only multipath");
  const auto light = report.at("bounced_light");
  EXPECT_TRUE(light.at("removed").get<bool>());
  EXPECT_LT(light.at("before_mm").get<double>(), -17);
  EXPECT_LT(std::abs(light.at("after_mm").get<double>()), 3);
  EXPECT_LT(report.at("evaluate").at("surface").at("p50_mm").get<double>(), 11.0);
}

/// The sweep shows the ceiling with its lamps, which are four times as bright as the plates' white.
TEST_F(RoomScan, LampsHaveTheirLightWherePlatesWereTakenAtOtherExposures) {
  const auto report =
      scanned("--rig sr3000 --seed 31 --field 40x180 --view-frames 2 --bracket", "");
  const auto exposures = report.at("bracket");
  ASSERT_GE(exposures.size(), 2U);
  for (const auto& e : exposures) {
    // The camera exposes 9 us longer than its setting of 8 ms.
    const double s = 8e-3 * e.at("nominal").get<double>();
    EXPECT_TRUE(e.at("used").get<bool>());
    EXPECT_NEAR(e.at("measured").get<double>() / ((s + 9e-6) / (8e-3 + 9e-6)), 1, 0.03) << e;
  }
  const auto light = report.at("evaluate").at("light");
  EXPECT_GT(light.at("lamps").at("places").get<int>(), 200);
  EXPECT_LT(light.at("lamps").at("saturated_pct").get<double>(), 5);
  EXPECT_LT(light.at("lamps").at("p50_pct").get<double>(), 5);
  EXPECT_LT(light.at("bright").at("p50_pct").get<double>(), 5);
  EXPECT_TRUE(std::filesystem::exists(path("room/color.exr")));
}

}  // namespace
}  // namespace mixrig::test
