// SPDX-License-Identifier: Apache-2.0
// The viewfinder on the board's own screen: kernel mode setting, no desktop. The display is as
// large as the picture, so that the two are compared pixel by pixel.
#include "tests/board/screen.h"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "host/image_io/image_io.h"
#include "tests/board/bench.h"
#include "tests/board/rig_bench.h"
#include "tests/support/child_process.h"

namespace mixrig::board {
namespace {

constexpr const char* kStill = "/host/takes/still";

bool equal(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  return true;
}

class Screen : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_screen()) GTEST_SKIP() << "this boot has no screen";
  }
  static bool shows(const Image<Rgb8>& wanted) {
    return wait_until(
        [&] {
          const auto seen = screenshot();
          return seen && equal(*seen, wanted);
        },
        60s);
  }
  static Image<Rgb8> read(const fs::path& file) {
    Image<Rgb8> picture;
    EXPECT_TRUE(image_io::read_rgb8(file, picture)) << file;
    return picture;
  }
};

TEST_F(Screen, ShowsCompositeAndPlatePixelByPixelAndObeysKeys) {
  test::ChildProcess child({"mixrig", "run", std::string(kStill) + "/scene.toml", "--source",
                            std::string("rig:") + kStill + "/rig.toml", "--view", "--out",
                            "/tmp/out", "--json", "/tmp/screen.json"},
                           600, "/tmp/screen.log");
  const Image<Rgb8> plate = read(std::string(kStill) + "/color/000020.png");
  const auto written = [] { return fs::exists("/tmp/out.partial/composite/color/000020.png"); };
  EXPECT_TRUE(wait_until(written, 120s)) << run("cat /tmp/screen.log").text;
  const auto composite = screenshot();
  EXPECT_TRUE(press("2"));
  EXPECT_TRUE(shows(plate)) << "the plate after the key 2";
  EXPECT_TRUE(press("1"));
  EXPECT_TRUE(press("q"));
  EXPECT_EQ(child.wait(), 0) << run("cat /tmp/screen.log").text;
  ASSERT_TRUE(composite) << to_line(composite.error());
  int same = 0, all = 0;
  for (const auto& entry : fs::directory_iterator("/tmp/out/composite/color")) {
    same += equal(*composite, read(entry.path()));
    ++all;
  }
  const Json report = read_json("/tmp/screen.json");
  const Json& shown = report["viewfinder"];
  measured("screen %dx%d, %s: equal to %d of %d composites; %d shown, %d replaced",
           composite->width(), composite->height(), shown["driver"].get<std::string>().c_str(),
           same, all, shown["shown"].get<int>(), shown["replaced"].get<int>());
  EXPECT_FALSE(equal(*composite, plate));
  EXPECT_GT(same, 0) << "what the screen showed is one of the composites";
  EXPECT_NE(shown["driver"].get<std::string>().find("KMSDRM"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::board
