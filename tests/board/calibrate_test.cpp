// SPDX-License-Identifier: Apache-2.0
// `mixrig calibrate` of the package: estimates the lens of the target camera from the studio's
// board views in MIXRIG_BOARD_TAKES and compares it with the true lens, which the take of the same
// rig has.
#include <cmath>
#include <cstdlib>
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/board/bench.h"

namespace mixrig::board {
namespace {

TEST(Calibrate, FindsTheLensOfTheTargetCamera) {
  const char* const takes = std::getenv("MIXRIG_BOARD_TAKES");
  if (takes == nullptr) GTEST_SKIP() << "MIXRIG_BOARD_TAKES names no folder";
  const std::string folder = takes;
  const Ran ran = run("mixrig calibrate intrinsics " + folder +
                      "/board/target/*.png --board checkerboard:9x6:70mm --lens 5 "
                      "--out /tmp/lens.toml --json /tmp/lens.json");
  ASSERT_EQ(ran.status, 0) << ran.text;
  std::ifstream file("/tmp/lens.json");
  const auto lens = nlohmann::json::parse(file);
  for (const std::string name : {"fx", "fy", "cx", "cy"}) {
    const auto& found = lens.at("parameters").at(name);
    const double value = found.at("value"), sigma = found.at("sigma");
    const double truth = std::atof(
        run("awk '$1 == \"" + name + "\" { print $3; exit }' " + folder + "/walk/take.toml")
            .text.c_str());
    measured("%s %.3f +- %.3f px, truly %.3f", name.c_str(), value, sigma, truth);
    EXPECT_LT(std::abs(value - truth), 4 * sigma + 0.02) << name;
    EXPECT_LT(sigma, 0.2) << name;
  }
}

}  // namespace
}  // namespace mixrig::board
