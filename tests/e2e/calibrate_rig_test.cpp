// SPDX-License-Identifier: Apache-2.0
// `mixrig calibrate rig` and `calibrate tof` on a bent board of the studio, compared with the
// truth.
#include <cmath>

#include "tests/e2e/rig_error.h"

namespace mixrig::test {
namespace {

using nlohmann::json;

class CalibrateRig : public RefusingCommandTest {};

TEST_F(CalibrateRig, finds_rig_and_bend_and_reports_a_square_of_the_wrong_size) {
  ASSERT_EQ(
      studio("set",
             "--plain --scenario board --rig kinect2 --seed 21 --views 9 --size 320x256 --bend 2"
             " --tolerance 1 --depth-error 15"),
      0);
  const std::string out = path("calibration.toml");
  ASSERT_EQ(mixrig("calibrate rig " + path("set") + " --out " + out + " --json " + path("r.json")),
            0);
  const json found = report("r.json"), truth = report("set/truth/truth.json");
  const json& cameras = found.at("cameras");
  const double f = cameras.at("target").at("parameters").at(0);
  EXPECT_NEAR(f / truth.at("target").at("fx").get<double>(), 1, 2e-4);
  for (const char* name : {"tof", "fisheye"}) {
    const json& pose = truth.at(std::string("target_from_") + name);
    EXPECT_LT(off_mm(cameras.at(name), pose), 0.1) << name;
    EXPECT_LT(off_deg(cameras.at(name), pose), 0.02) << name;
    EXPECT_LT(2 * off_mm(cameras.at(name), pose), off_mm(found.at("by_corners").at(name), pose))
        << name;
  }
  // The fisheye of 185 degrees: its limit is the rim of its image circle.
  const std::string written = text_of_file(out), key = "max_angle_rad = ";
  ASSERT_NE(written.find(key), std::string::npos);
  EXPECT_NEAR(std::stod(written.substr(written.find(key) + key.size())) * 180 / M_PI, 92.5, 0.3);
  EXPECT_NEAR(found.at("bend_mm").get<double>(), 2, 0.1);
  EXPECT_NE(found.at("warnings").dump().find("bent"), std::string::npos);
  const json& depth = found.at("depth_error");
  EXPECT_LT(depth.at("held_out_mm").get<double>(), 0.6 * depth.at("uncorrected_mm").get<double>());

  // If the views state another size of the squares, nothing is written and the old file is kept.
  const std::string before = text_of_file(out);
  std::string text = text_of_file(path("set/views.toml"));
  ASSERT_NE(text.find("square_mm = 70"), std::string::npos);
  std::ofstream(path("set/views.toml"))
      << text.replace(text.find("square_mm = 70"), 14, "square_mm = 75");
  std::string error_line;
  EXPECT_EQ(refused("calibrate tof --corners-only " + path("set") + " --out " + out, error_line),
            1);
  EXPECT_NE(error_line.find("square"), std::string::npos) << error_line;
  EXPECT_EQ(text_of_file(out), before);
  // Pictures of one camera under the name of another have the wrong size.
  text = text_of_file(path("set/views.toml"));
  std::ofstream(path("set/views.toml"))
      << text.replace(text.find("target/%06d.png"), 15, "fisheye/%06d.png");
  EXPECT_EQ(refused("calibrate rig " + path("set") + " --out " + out, error_line), 2);
  EXPECT_NE(error_line.find("swapped"), std::string::npos) << error_line;
  EXPECT_EQ(text_of_file(out), before);
}

}  // namespace
}  // namespace mixrig::test
