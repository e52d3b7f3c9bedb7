// SPDX-License-Identifier: Apache-2.0
// The viewfinder on the board's own screen: kernel mode setting, no desktop. The display has the
// picture's size, so that the two are compared pixel by pixel.
#include "tests/board/screen.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/math/image_io/image_io.h"
#include "tests/board/bench.h"
#include "tests/support/child_process.h"

namespace mixrig::board {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStill = "/host/takes/still";

nlohmann::json json_of(const std::string& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file, nullptr, false);
}

class Screen : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_screen()) GTEST_SKIP() << "this boot has no screen";
  }
  /// Waits until the upper `rows` of the screen are `wanted`. Below them the viewfinder writes the
  /// name of views other than the composite.
  static bool shows(const Image<Rgb8>& wanted, int rows) {
    return wait_until(
        [&] {
          const auto seen = screenshot();
          return seen && differing(*seen, wanted, rows) == 0;
        },
        60s, 300ms);
  }
  static Image<Rgb8> read(const fs::path& file) {
    Image<Rgb8> picture;
    EXPECT_TRUE(image_io::read_rgb8(file, picture)) << file;
    return picture;
  }
};

TEST_F(Screen, ShowsCompositeAndPlatePixelByPixelAndObeysKeys) {
  const std::string still = kStill;
  const Image<Rgb8> composite = read(still + "/reference/composite/color/000002.png");
  test::ChildProcess child({"mixrig", "run", still + "/scene.toml", "--source",
                            "rig:" + still + "/rig.toml", "--view", "--json", "/tmp/screen.json"},
                           900, "/tmp/screen.log");
  EXPECT_TRUE(shows(composite, composite.height())) << run("cat /tmp/screen.log").text;
  EXPECT_TRUE(press("2"));
  EXPECT_TRUE(shows(read(still + "/color/000020.png"), 230)) << "the plate after the key 2";
  EXPECT_TRUE(press("q"));
  ASSERT_EQ(child.wait(), 0) << run("cat /tmp/screen.log").text;
  const auto report = json_of("/tmp/screen.json");
  const auto& shown = report["viewfinder"];
  measured("%s: %d shown, %d replaced", shown["driver"].get<std::string>().c_str(),
           shown["shown"].get<int>(), shown["replaced"].get<int>());
  EXPECT_NE(shown["driver"].get<std::string>().find("KMSDRM"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::board
