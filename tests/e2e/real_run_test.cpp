// SPDX-License-Identifier: Apache-2.0
// `mixrig run` on a real recording (label data) in which people enter and leave a room.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/e2e/command.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::test {
namespace {

class RealRun : public CommandTest {
 protected:
  void SetUp() override {
    if (std::getenv("MIXRIG_DATA") == nullptr)
      GTEST_SKIP() << "needs recordings: set MIXRIG_DATA to the folder that holds them";
  }
  const std::string lab_ =
      std::string(std::getenv("MIXRIG_SOURCE") ? std::getenv("MIXRIG_SOURCE") : ".") +
      "/tests/data/lab_queue";
};

TEST_F(RealRun, EmptyFramesOfTheLabKeyNothingAndPeopleAreKeyed) {
  ASSERT_EQ(mixrig("scan --take " + lab_ + "/take.toml --frames 1-26 " + path("background")), 0);
  ASSERT_EQ(mixrig("run " + lab_ + "/scene.toml --source take:" + lab_ + "/take.toml --out " +
                   path("out") + " --backend cpu --format none --json " + path("report.json")),
            0);
  const std::vector<double> foreground_pct = column(path("out") + "/frames.csv", 4);
  ASSERT_EQ(foreground_pct.size(), 108U - 26U);
  EXPECT_EQ(report("report.json").at("frames"), 108 - 26);
  for (int frame = 103; frame <= 108; ++frame)
    EXPECT_LE(foreground_pct[static_cast<std::size_t>(frame - 27)], 0.1)
        << "frame " << frame << " is empty";
  EXPECT_GE(*std::max_element(foreground_pct.begin(), foreground_pct.end()), 15.0);
}

/// People stand in most of frames 27 to 90 and in few of 1 to 26.
TEST_F(RealRun, PeopleInTheFramesToLearnFromAreLeftOutOfTheRoom) {
  std::vector<std::vector<double>> foreground_pct;
  for (const char* frames : {"7-26", "1-90", "27-90"}) {
    const std::string name = path(std::string("room-") + frames), out = name + "-out";
    ASSERT_EQ(mixrig("scan --take " + lab_ + "/take.toml --frames " + frames + " " + name), 0);
    std::ofstream(name + ".toml") << "[camera]\npose = \"floor\"\n[background]\nmodel = \"" << name
                                  << "\"\n[key]\nthreshold_m = 0.08\nnoise_factor = 4.0\n";
    ASSERT_EQ(mixrig("run " + name + ".toml --source take:" + lab_ + "/take.toml --frames 91-108 " +
                     "--out " + out + " --backend cpu --format none"),
              0);
    foreground_pct.push_back(column(out + "/frames.csv", 4));
    ASSERT_EQ(foreground_pct.back().size(), 18U);
  }
  for (const auto& learned : foreground_pct)
    for (std::size_t i = 0; i < learned.size(); ++i) {
      const double empty_pct = foreground_pct[0][i];
      EXPECT_NEAR(learned[i], empty_pct, 0.3 + 0.1 * empty_pct) << "frame " << 91 + i;
    }
}

/// A room that was saved with the people of frame 60, and without.
TEST_F(RealRun, ABackgroundWithPeopleInItIsToldAfterASecond) {
  std::string take = read_bytes(lab_ + "/take.toml");
  std::filesystem::create_directory(path("still"));
  for (const std::string name : {"color", "depth"}) {
    const std::string file = name + (name == "color" ? "/%04d.jpg" : "/%04d.png");
    const std::size_t at = take.find(file), end = take.find("count = 108\n", at);
    ASSERT_NE(end, std::string::npos);
    take.replace(at, end + 11 - at, path("still/" + name + ".txt\""));
    std::ofstream list(path("still/" + name + ".txt"));
    for (const char* time : {"0.0 ", "0.1 ", "0.2 "})
      list << time << name << "/0060" << file.substr(file.size() - 4) << "\n";
  }
  std::ofstream(path("still/take.toml")) << take;
  ASSERT_EQ(mixrig("scan --take " + path("still") + " --frames 1-3 " + path("people")), 0);
  ASSERT_EQ(mixrig("scan --take " + lab_ + "/take.toml --frames 7-26 " + path("empty")), 0);
  for (const std::string room : {"people", "empty"}) {
    std::ofstream(path("scene.toml"))
        << "[camera]\npose = \"identity\"\n[background]\nmodel = \"" << path(room) << "\"\n";
    ASSERT_EQ(mixrig("run " + path("scene.toml") + " --source take:" + lab_ +
                     "/take.toml --frames 1-30 --backend cpu"),
              0);
    EXPECT_EQ(read_bytes(path("log")).find("depth lies behind it") != std::string::npos,
              room == "people");
  }
}

/// A Kinect v1 whose colour its driver puts onto the depth, and the same with its centre 6 px
/// aside.
TEST_F(RealRun, InfoMeasuresHowFarDepthStepsLieFromThePicturesEdges) {
  const std::string take =
      std::string(std::getenv("MIXRIG_SOURCE") ? std::getenv("MIXRIG_SOURCE") : ".") +
      "/tests/data/kinect1_turntable/take.toml";
  std::string text = read_bytes(take);
  const std::size_t at = text.find("cx = ", text.find("[target]"));
  ASSERT_NE(at, std::string::npos);
  const double cx_px = std::stod(text.substr(at + 5));
  text.replace(at, text.find('\n', at) - at, "cx = " + std::to_string(cx_px + 6));
  std::filesystem::create_directory(path("aside"));
  std::ofstream(path("aside") + "/take.toml") << text;
  std::vector<double> median_px;
  for (const std::string& of : {take, path("aside") + "/take.toml"}) {
    ASSERT_EQ(mixrig("info " + of + " --json " + path("info.json")), 0);
    const auto found = report("info.json").at("registration");
    EXPECT_GE(found.at("matched_share"), 0.5);
    median_px.push_back(found.at("median_px"));
  }
  EXPECT_LE(median_px[0], 3.0);
  EXPECT_GE(median_px[1], 4.5);
}

}  // namespace
}  // namespace mixrig::test
