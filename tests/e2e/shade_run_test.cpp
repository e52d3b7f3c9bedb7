// SPDX-License-Identifier: Apache-2.0
// Lamps that are hidden already: an object in the shade of a table casts no second shadow.
#include <fstream>

#include <gtest/gtest.h>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class ShadeRun : public CommandTest {
 protected:
  double shadow_rmse(const std::string& scene) {
    EXPECT_EQ(mixrig("run " + scene + " --source take:" + path("take") + " --backend cpu --json " +
                     path("report.json")),
              0);
    return report("report.json").at("error").at("light_shadow_rmse").get<double>();
  }
};

TEST_F(ShadeRun, AnObjectInTheShadeOfATableIsNotShadedTwice) {
  // The table of 1.28 m hides the lamp at (3.75, 3.2) from there.
  ASSERT_EQ(mixrig("studio --plain " + path("take") +
                   " --scenario edges --seed 5 --object 1.5,3.0 --eye 0.5,1.0,1.6 --look-at "
                   "1.4,3.0,0.5 --frames 8 --size 320x256"),
            0);
  EXPECT_LE(shadow_rmse(path("take/scene.toml")), 0.05);
  // Behind open walls nothing real hides a lamp.
  std::ifstream in(path("take/scene.toml"));
  std::ofstream out(path("take/open.toml"));
  for (std::string line; std::getline(in, line);)
    out << line << (line == "[background]" ? "\nwalls = \"open\"\n" : "\n");
  out.close();
  EXPECT_GT(shadow_rmse(path("take/open.toml")), 0.05);
}

}  // namespace
}  // namespace mixrig::test
