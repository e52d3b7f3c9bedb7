// SPDX-License-Identifier: Apache-2.0
// Lamps that are hidden already: an object in the shade of a table casts no second shadow.
#include <gtest/gtest.h>

#include "tests/e2e/command.h"
#include "tests/e2e/shadows.h"

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
                   " --scenario edges --seed 5 --object 1.4,2.9 --frames 8 --size 320x256"),
            0);
  EXPECT_LE(shadow_rmse(path("take/scene.toml")), 0.05);
}

}  // namespace
}  // namespace mixrig::test
