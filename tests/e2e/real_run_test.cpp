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

/// The same recording as a rig, whose colour camera is where the driver says, and 12 px aside.
TEST_F(RealRun, DiagWarnsOfDepthBesideWhatItBelongsTo) {
  const std::string own =
      std::string(std::getenv("MIXRIG_SOURCE") ? std::getenv("MIXRIG_SOURCE") : ".") +
      "/tests/data/kinect1_turntable/take.toml";
  std::string text = read_bytes(own);
  for (const std::string table : {"[color]\n", "[depth]\n"})
    text.insert(text.find(table) + table.size(), "rate_hz = 10.0\n");
  std::filesystem::create_directory(path("timed"));
  std::ofstream(path("timed") + "/take.toml") << text;
  const std::string camera = "size_px = [640, 480]\nfx = 525.0\nfy = 525.0\ncy = 240.0\ncx = ";
  const auto diag = [&](const std::string& take, const char* cx) {
    std::ofstream(path("rig.toml"))
        << "format = 1\nname = \"played\"\n[[camera]]\nname = \"target\"\nuri = \"take:" << take
        << "/color\"\n[depth]\nuri = \"take:" << take << "/depth\"\n[target]\n"
        << camera << cx << "\n[tof]\n"
        << camera << "320.0\n[target_from_tof]\nrotation_xyzw = [0, 0, 0, 1]\n"
        << "translation_m = [0, 0, 0]\n";
    return "diag --no-move --watch 0.5 --rig " + path("rig.toml") + " --json " + path("diag.json");
  };
  std::vector<std::string> verdicts;
  for (const char* cx : {"320.0", "332.0"}) {
    ASSERT_EQ(mixrig(diag(path("timed"), cx)), 0);
    const nlohmann::json told = report("diag.json");
    for (const nlohmann::json& check : told.at("checks"))
      if (check.at("check") == "registration") verdicts.push_back(check.at("verdict"));
  }
  EXPECT_EQ(verdicts, (std::vector<std::string>{"pass", "warn"}));
  // Without a rate it cannot be played, which each of its devices says.
  EXPECT_NE(refusal(diag(own, "320.0")).find("target open, depth open"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::test
