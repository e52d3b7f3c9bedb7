// SPDX-License-Identifier: Apache-2.0
// Lamps that real objects already hide: a virtual object in the shade of a table casts no second
// shadow.
#include <fstream>

#include <gtest/gtest.h>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class ShadeRun : public CommandTest {
 protected:
  double error_of(const std::string& key, const std::string& scene,
                  const std::string& options = " --backend cpu") {
    EXPECT_EQ(mixrig("run " + scene + " --source take:" + path("take") + options + " --json " +
                     path("report.json")),
              0);
    return report("report.json").at("error").at(key).get<double>();
  }
  double shadow_rmse(const std::string& scene) { return error_of("light_shadow_rmse", scene); }
  /// Writes the take's scene with a line added after the header of a table, and returns its path.
  std::string scene_with(const std::string& table, const std::string& added) {
    std::ifstream in(path("take/scene.toml"));
    std::ofstream out(path("take/other.toml"));
    for (std::string line; std::getline(in, line);)
      out << line << (line == table ? "\n" + added + "\n" : "\n");
    return path("take/other.toml");
  }
  /// Writes the take's scene with a table added at its end, and returns its path.
  std::string scene_and(const std::string& table) {
    std::ofstream(path("take/other.toml"))
        << std::ifstream(path("take/scene.toml")).rdbuf() << "\n" + table;
    return path("take/other.toml");
  }
};

TEST_F(ShadeRun, AnObjectInTheShadeOfATableIsNotShadedTwice) {
  // A table of 1.28 m hides the lamp at (3.75, 3.2) from the object.
  ASSERT_EQ(studio("take",
                   "--plain --scenario edges --seed 5 --object 1.5,3.0 --eye 0.5,1.0,1.6 --look-at "
                   "1.4,3.0,0.5 --frames 8 --size 320x256"),
            0);
  EXPECT_LE(shadow_rmse(path("take/scene.toml")), 0.05);
  // With open walls, the real surfaces of the room hide no lamp.
  EXPECT_GT(shadow_rmse(scene_with("[background]", "walls = \"open\"")), 0.05);
}

TEST_F(ShadeRun, ALampThatIsDimmedIsFollowed) {
  // The third lamp, the brightest one, falls to a fifth in the middle of the frames.
  ASSERT_EQ(
      studio("take", "--plain --scenario walk --seed 7 --frames 62 --size 160x128 --dim 3,1.5,0.2"),
      0);
  const double without = shadow_rmse(path("take/scene.toml"));
  EXPECT_LE(shadow_rmse(scene_with("[light]", "follow = true")), 0.6 * without);
  const nlohmann::json changed = report("report.json").at("light").at("changed");
  ASSERT_EQ(changed.size(), 1U) << changed;
  EXPECT_EQ(changed[0].at("lamp"), "ceiling 3");
  EXPECT_NEAR(changed[0].at("factor").get<double>(), 0.2, 0.1);
  EXPECT_LE(changed[0].at("frame").get<int>(), 39 + 25) << "a second after it";
}

TEST_F(ShadeRun, APersonBetweenALampAndAnObjectDarkensItAndItsShadow) {
  // From frame 40 on a person walks between the lamp at (3.75, 1.1) and the object.
  ASSERT_EQ(studio("take",
                   "--plain --scenario walk --seed 7 --frames 46 --size 160x128 --object 4.1,2.6"),
            0);
  const std::string cast = path("take/scene.toml");
  const std::string none = scene_and("[quality]\nlight = \"shadows\"\n");
  for (const std::string backend : {"cpu", "gles"}) {
    const std::string options = " --frames 40-46 --backend " + backend;
    EXPECT_LE(error_of("object_rmse", cast, options), 0.65 * error_of("object_rmse", none, options))
        << backend;
    // The floor that the person shades is not shaded by the object again.
    EXPECT_LE(error_of("light_shadow_rmse", cast, options),
              0.8 * error_of("light_shadow_rmse", none, options))
        << backend;
  }
}

}  // namespace
}  // namespace mixrig::test
