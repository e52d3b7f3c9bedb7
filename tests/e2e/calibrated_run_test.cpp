// SPDX-License-Identifier: Apache-2.0
// A take with wrong camera parameters, and the calibration.toml that corrects them; errors are
// measured against the studio's truth.
#include <sstream>

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/take/take.h"
#include "tests/e2e/command.h"

namespace mixrig::test {
namespace {

class CalibratedRun : public CommandTest {
 protected:
  /// Runs "take" and returns depth_mae_mm and key_iou.
  std::pair<double, double> errors(const std::string& words) {
    EXPECT_EQ(mixrig("run " + path("take/scene.toml") + " --source take:" + path("take") +
                     " --out " + path("out") + " --backend cpu --format none --json " +
                     path("report.json") + " " + words),
              0);
    const auto error = report("report.json").at("error");
    return {error.at("depth_mae_mm").get<double>(), error.at("key_iou").get<double>()};
  }
  /// The studio's true camera parameters as a calibration.
  calibration_file::Calibration truth() const {
    const auto reader = take::TakeReader::open(folder_ / "take");
    const take::TakeInfo& info = reader->info();
    calibration_file::Calibration known;
    known.cameras = {{"target", info.target, {}, 0, 0, 0, {}}, {"tof", info.tof, {}, 0, 0, 0, {}}};
    known.poses = {{"tof", info.target_from_tof, {}, 0, 0, {}}};
    return known;
  }
  /// Sets the line of `key` under [table] of take.toml.
  void edit(const std::string& table, const std::string& key, const std::string& value) {
    std::ifstream in(folder_ / "take/take.toml");
    std::ostringstream out;
    std::string line, here;
    while (std::getline(in, line)) {
      if (line.starts_with("[")) here = line;
      const bool found = here == "[" + table + "]" && line.starts_with(key + " =");
      out << (found ? key + " = " + value : line) << "\n";
    }
    in.close();
    std::ofstream(folder_ / "take/take.toml") << out.str();
  }
};

TEST_F(CalibratedRun, ReturnsToTheFiguresOfTheRightOne) {
  ASSERT_EQ(
      studio("take", "--plain --scenario walk --rig kinect2 --seed 7 --frames 12 --size 320x256"),
      0);
  const auto right = errors("");
  const calibration_file::Calibration known = truth();
  ASSERT_TRUE(calibration_file::write_calibration(path("take/right.toml"), known));
  const double fx_px = std::get<geometry::CameraModel>(known.cameras[1].model).pinhole.fx_px;
  edit("tof", "fx", std::to_string(1.06 * fx_px));
  edit("tof", "distortion", "[0.0, 0.0, 0.0, 0.0]");
  edit("target_from_tof", "translation_m", "[0.05, 0.02, 0.08]");
  const auto wrong = errors("");
  EXPECT_GT(wrong.first, 2 * right.first);
  EXPECT_LT(wrong.second, right.second - 0.02);

  const auto by_option = errors("--calibration " + path("take/right.toml"));
  std::printf("depth %.2f mm, key %.4f; wrong %.2f mm, %.4f; by --calibration %.2f mm, %.4f\n",
              right.first, right.second, wrong.first, wrong.second, by_option.first,
              by_option.second);
  EXPECT_NEAR(by_option.first, right.first, 1e-3 * right.first);
  EXPECT_NEAR(by_option.second, right.second, 1e-4);

  std::ifstream in(folder_ / "take/take.toml");
  const std::string manifest{std::istreambuf_iterator<char>(in), {}};
  std::ofstream(folder_ / "take/take.toml") << "calibration = \"right.toml\"\n" << manifest;
  EXPECT_EQ(errors(""), by_option) << "named by the take";
}

}  // namespace
}  // namespace mixrig::test
