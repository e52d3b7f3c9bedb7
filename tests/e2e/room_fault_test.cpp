// SPDX-License-Identifier: Apache-2.0
// Sweeps with a fault through `mixrig scan --take`. The bounds were chosen on the take itself: 95 %
// of the surface within 2.44 mm, 3.65 mm with the fault, 2.45 mm with the fault corrected.
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <sstream>

#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class RoomFault : public CommandTest {
 protected:
  /// Adds `by_rad` to the pan angle of `count` frames from `first` on.
  void shift_pan(int first, int count, double by_rad) const {
    std::ifstream in(path("take/pan_tilt.csv"));
    std::ostringstream out;
    std::string line;
    std::getline(in, line);
    out << line << '\n';
    while (std::getline(in, line)) {
      int frame = 0;
      double pan_rad = 0, tilt_rad = 0;
      ASSERT_EQ(std::sscanf(line.c_str(), "%d,%lf,%lf", &frame, &pan_rad, &tilt_rad), 3) << line;
      if (frame >= first && frame < first + count) pan_rad += by_rad;
      out << frame << std::setprecision(10) << ',' << pan_rad << ',' << tilt_rad << '\n';
    }
    in.close();
    std::ofstream(path("take/pan_tilt.csv")) << out.str();
  }
};

/// The encoders of one view are half a degree off: the view is reported and turned back, and the
/// room is as good as without the error.
TEST_F(RoomFault, AViewWithAWrongAngleIsNamedAndMended) {
  ASSERT_EQ(studio("take",
                   "--scenario sweep --plain --size 64x48 --rig kinect2 --seed 31 --field 120x50 "
                   "--overlap 0.2 --view-frames 2"),
            0);
  const auto scan = [&](const std::string& options) {
    EXPECT_EQ(mixrig("scan --take " + path("take") + " --calibration " +
                     path("take/truth/calibration.toml") + " " + path("room") + " --evaluate " +
                     options + " --json " + path("room.json")),
              0);
    return report("room.json");
  };
  const auto turned = [](const nlohmann::json& report) {
    std::vector<nlohmann::json> found;
    for (const auto& finding : report.at("findings"))
      if (finding.at("kind") == "turned_view") found.push_back(finding);
    return found;
  };
  const auto sound = scan("");
  EXPECT_TRUE(turned(sound).empty()) << sound.at("findings");
  shift_pan(3, 2, 0.5 * M_PI / 180);
  const auto mended = scan(""), left = scan("--no-align");
  ASSERT_EQ(turned(mended).size(), 1U) << mended.at("findings");
  EXPECT_EQ(turned(mended)[0].at("view"), 2);
  EXPECT_NEAR(turned(mended)[0].at("value").get<double>(), 0.5, 0.1);
  const auto p95_mm = [](const nlohmann::json& report) {
    return report.at("evaluate").at("surface").at("p95_mm").get<double>();
  };
  EXPECT_GT(p95_mm(left), 1.1 * p95_mm(sound));
  EXPECT_LT(p95_mm(mended), 1.03 * p95_mm(sound));
}

/// A lens darkens the corners: the overlaps of a sweep show by how much, and a calibration that has
/// this value gives composites whose corners are as bright as the middle. The bounds were chosen on
/// the takes themselves (overlaps 11.2 % apart without, 1.3 % with the correction).
TEST_F(RoomFault, DarkCornersAreFoundAndTakenOut) {
  const std::string camera = " --only vignetting --size 160x128 --rig kinect2 --seed 31";
  ASSERT_EQ(
      studio("take", "--scenario sweep --field 120x50 --overlap 0.2 --view-frames 1" + camera), 0);
  const std::string calibration = path("take/truth/calibration.toml");
  ASSERT_EQ(mixrig("scan --take " + path("take") + " --calibration " + calibration + " " +
                   path("room") + " --json " + path("room.json")),
            0);
  const auto gains = report("room.json").at("gains");
  EXPECT_LT(gains.at("after_pct").get<double>(), 0.5 * gains.at("before_pct").get<double>());
  EXPECT_NEAR(gains.at("largest_factor").get<double>(), 1, 0.02);
  // Light falls by cos^1.6 of the angle to the axis; the corner is some 36 degrees from it.
  EXPECT_NEAR(gains.at("corners_pct").get<double>(), 100 * (1 - std::pow(std::cos(0.62), 1.6)), 3);
  ASSERT_EQ(studio("walk", "--scenario handheld --frames 8" + camera), 0);
  const auto psnr_db = [&](const std::string& file) {
    EXPECT_EQ(mixrig("run " + path("walk/scene.toml") + " --source take:" + path("walk") +
                     " --calibration " + file + " --format none --out " + path("out") + " --json " +
                     path("run.json")),
              0);
    return report("run.json").at("error").at("color_psnr_db").get<double>();
  };
  const double before = psnr_db(path("walk/truth/calibration.toml"));
  ASSERT_EQ(mixrig("calibrate vignetting " + path("room") + " --out " +
                   path("walk/truth/calibration.toml")),
            0);
  EXPECT_GT(psnr_db(path("walk/truth/calibration.toml")), before + 2);
}

}  // namespace
}  // namespace mixrig::test
