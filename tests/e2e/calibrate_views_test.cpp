// SPDX-License-Identifier: Apache-2.0
// A board held by a person, through `mixrig calibrate views` and `calibrate rig`; a board before a
// unit that turns, through `calibrate views --turn` and `calibrate ptu`; and refused inputs.
#include <cmath>
#include <filesystem>

#include "tests/e2e/rig_error.h"

namespace mixrig::test {
namespace {

using nlohmann::json;

constexpr const char* kBoard = " --board checkerboard:9x6:70mm";

class CalibrateViews : public RefusingCommandTest {};

TEST_F(CalibrateViews, OfABoardHeldByHandAreKeptOnce) {
  ASSERT_EQ(
      studio("take",
             "--plain --scenario board --hand --rig kinect2 --seed 21 --views 8 --size 320x256"
             " --fisheye-size 640x512 --rest 0.4 --tremor 0.05 --tolerance 1"),
      0);
  ASSERT_EQ(mixrig("calibrate views " + path("views") + " --take " + path("take") + kBoard +
                   " --json " + path("v.json")),
            0);
  const json views = report("v.json");
  EXPECT_GE(views.at("shared").get<int>(), 5) << views.dump(1);
  EXPECT_LE(views.at("views").get<int>(), 8) << "a view is kept once";
  EXPECT_TRUE(std::filesystem::exists(path("views/coverage.png")));
}

/// Views of a hand-held board calibrate the rig without changes; another board is not found in
/// them.
TEST_F(CalibrateViews, OfABoardHeldByHandCalibrateTheRigAndAnotherBoardIsRefused) {
  ASSERT_EQ(studio("take",
                   "--plain --scenario board --hand --rig sr3000 --seed 7 --views 9 --size 320x256"
                   " --fisheye-size 64x64 --rest 0.4 --move 0.2 --tremor 0.05 --tolerance 1"
                   " --depth-error 15"),
            0);
  leave_out_fisheye(path("take/take.toml"));  // too small to show the board
  std::string said;
  EXPECT_EQ(refused("calibrate views " + path("none") + " --take " + path("take") +
                        " --board checkerboard:11x8:70mm",
                    said),
            1);
  EXPECT_NE(said.find("shows the board checkerboard:11x8:70mm"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(path("none")));
  ASSERT_EQ(mixrig("calibrate views " + path("views") + " --take " + path("take") + kBoard +
                   " --json " + path("v.json")),
            0);
  ASSERT_EQ(mixrig("calibrate rig " + path("views") + " --json " + path("r.json")), 0);
  EXPECT_GE(report("v.json").at("views").get<int>(), 7) << "of eight before the target camera";
  const json found = report("r.json"), truth = report("take/truth/truth.json");
  const json &target = found.at("cameras").at("target"), &tof = found.at("cameras").at("tof");
  EXPECT_NEAR(
      target.at("parameters").at(0).get<double>() / truth.at("target").at("fx").get<double>(), 1,
      2e-4);
  EXPECT_LT(off_mm(tof, truth.at("target_from_tof")), 0.3);
  EXPECT_LT(off_deg(tof, truth.at("target_from_tof")), 0.03);
  const json& depth = found.at("depth_error");
  EXPECT_LT(depth.at("held_out_mm").get<double>(), 0.3 * depth.at("uncorrected_mm").get<double>());
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
  // An angle file in radians whose header says degrees.
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
      refused("calibrate views " + path("v") + " --take x --board checkerboard:9x7:70mm", said), 2);
  EXPECT_NE(said.find("one odd and one even"), std::string::npos) << said;
  EXPECT_EQ(refused("calibrate views " + path("v") + " --take x --turn auto" + kBoard, said), 2);
  EXPECT_NE(said.find("give --rig"), std::string::npos) << said;
}

}  // namespace
}  // namespace mixrig::test
