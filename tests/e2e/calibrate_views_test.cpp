// SPDX-License-Identifier: Apache-2.0
// A board in the hands of a person, through mixrig calibrate views; a board before a unit that
// turns, through calibrate views --turn and calibrate ptu; and what is refused.
#include <cmath>
#include <filesystem>

#include "tests/e2e/rig_error.h"

namespace mixrig::test {
namespace {

using nlohmann::json;

constexpr const char* kBoard = " --board checkerboard:9x6:70mm";

class CalibrateViews : public RefusingCommandTest {};

TEST_F(CalibrateViews, OfABoardHeldByHandAreKeptOnceAndAnotherBoardIsRefused) {
  ASSERT_EQ(mixrig("studio --plain " + path("take") +
                   " --scenario board --hand --rig kinect2 --seed 21 --views 8 --size 320x256"
                   " --fisheye-size 640x512 --rest 0.4 --tremor 0.05 --tolerance 1"),
            0);
  std::string said;
  EXPECT_EQ(refused("calibrate views " + path("none") + " --source take:" + path("take") +
                        " --board checkerboard:11x8:70mm",
                    said),
            1);
  EXPECT_NE(said.find("shows the board checkerboard:11x8:70mm"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(path("none")));
  ASSERT_EQ(mixrig("calibrate views " + path("views") + " --source take:" + path("take") + kBoard +
                   " --json " + path("v.json")),
            0);
  const json views = report("v.json");
  EXPECT_GE(views.at("shared").get<int>(), 5) << views.dump(1);
  EXPECT_LE(views.at("views").get<int>(), 8) << "a view is kept once";
  EXPECT_TRUE(std::filesystem::exists(path("views/coverage.png")));
}

TEST_F(CalibrateViews, OfATurningUnitCalibrateItAndRadiansAreRefused) {
  const std::string device = "uri = \"studio:turn,7,sr3000,,320x256";
  std::ofstream(path("rig.toml")) << "format = 1\n[[camera]]\nname = \"target\"\n"
                                  << device << "/target\"\n[depth]\nname = \"tof\"\n"
                                  << device << "/tof\"\n[pan_tilt]\n"
                                  << device << "/head\"\n";
  ASSERT_EQ(mixrig("calibrate views " + path("turn") + " --rig " + path("rig.toml") + kBoard +
                   " --turn auto --turn-views 8 --frames 3"),
            0);
  ASSERT_EQ(mixrig("calibrate ptu " + path("turn")), 0);
  // The same angles in radians under a header that says degrees.
  std::ifstream in(path("turn/ptu.csv"));
  std::string line, text;
  std::getline(in, line);
  text = line + "\n";
  int view = 0;
  double pan = 0, tilt = 0;
  while (std::getline(in, line) && std::sscanf(line.c_str(), "%d,%lf,%lf", &view, &pan, &tilt) == 3)
    text += std::to_string(view) + "," + std::to_string(pan * M_PI / 180) + "," +
            std::to_string(tilt * M_PI / 180) + "\n";
  in.close();
  std::ofstream(path("turn/ptu.csv")) << text;
  std::string said;
  EXPECT_EQ(refused("calibrate ptu " + path("turn"), said), 1);
  EXPECT_NE(said.find("they are radians, where degrees are wanted"), std::string::npos) << said;
}

TEST_F(CalibrateViews, ArgumentsThatDoNotFitAreRefusedInOneLine) {
  std::string said;
  EXPECT_EQ(refused("calibrate views " + path("v") + kBoard, said), 2);
  EXPECT_NE(said.find("give one of --rig"), std::string::npos) << said;
  EXPECT_EQ(
      refused("calibrate views " + path("v") + " --source take:x --board checkerboard:9x7:70mm",
              said),
      2);
  EXPECT_NE(said.find("one odd and one even"), std::string::npos) << said;
  EXPECT_EQ(refused("calibrate views " + path("v") + " --source take:x --turn auto" + kBoard, said),
            2);
  EXPECT_NE(said.find("give --rig"), std::string::npos) << said;
}

}  // namespace
}  // namespace mixrig::test
