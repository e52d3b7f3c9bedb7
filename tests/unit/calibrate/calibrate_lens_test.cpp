// SPDX-License-Identifier: Apache-2.0
// `mixrig calibrate lens`: its output and verdict, and its errors for bad input.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/calibrate/intrinsics/left_out_node.h"
#include "host/capture/calibration_file/calibration.h"
#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

/// Focal length 500 px times 2^(zoom / 100), `wrong` times that.
calibration_file::Calibration setting(double zoom, double wrong = 1) {
  const double f = 500 * std::pow(2, zoom / 100) * wrong;
  calibration_file::Calibration known;
  known.cameras = {
      {"target", geometry::CameraModel{{{640, 480}, f, f, 320, 240}, {}}, {}, 0.25, 8, 400, {}}};
  return known;
}

geometry::LensNode node(double zoom, double focus, double wrong = 1) {
  return {{zoom, focus},
          {std::get<geometry::CameraModel>(setting(zoom, wrong).cameras[0].model), 0},
          0};
}

TEST(LeaveOneOut, JudgesTheNodesBetweenOthers) {
  std::vector<geometry::LensNode> nodes;
  for (const double zoom : {0.0, 25.0, 50.0, 75.0, 100.0}) nodes.push_back(node(zoom, 0));
  const auto good = calibration::leave_one_out(*geometry::LensTable::make(nodes));
  ASSERT_TRUE(good) << good.error().context;
  ASSERT_EQ(good->size(), 3U);
  for (const auto& left : *good) EXPECT_LT(left.most_px, 1e-6);  // the logarithm is a line
  nodes[2] = node(50, 0, 1.01);
  const auto bad = calibration::leave_one_out(*geometry::LensTable::make(nodes));
  ASSERT_TRUE(bad);
  EXPECT_NEAR((*bad)[1].focal_pct, -100 * (1 - 1 / 1.01), 1e-6);
  EXPECT_NEAR((*bad)[1].most_px, 400 * (1 - 1 / 1.01), 0.02);  // 400 px from centre to corner
  EXPECT_GT((*bad)[1].rms_px, 1);
  EXPECT_LT((*bad)[1].rms_px, 4);
}

TEST(LeaveOneOut, GoesAlongFocusAtTheEndsOfTheZoom) {
  std::vector<geometry::LensNode> nodes;
  for (const double zoom : {0.0, 100.0})
    for (const double focus : {0.0, 1.0, 2.0}) nodes.push_back(node(zoom, focus));
  nodes[1] = node(0, 1, 1.02);
  const auto judged = calibration::leave_one_out(*geometry::LensTable::make(nodes));
  ASSERT_TRUE(judged) << judged.error().context;
  ASSERT_EQ(judged->size(), 2U);
  EXPECT_NEAR((*judged)[0].focal_pct, -100 * (1 - 1 / 1.02), 1e-6);
  EXPECT_LT((*judged)[1].most_px, 1e-6);
}

class CalibrateLens : public ::testing::Test {
 protected:
  CalibrateLens() {
    for (const int zoom : {0, 50, 100})
      EXPECT_TRUE(calibration_file::write_calibration(
          take_.path("z" + std::to_string(zoom) + ".toml"), setting(zoom)));
  }
  std::string error(const std::string& words) const {
    const Outcome outcome = take_.mixrig("calibrate lens " + words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    return outcome.err;
  }
  const TinyTake take_;
};

TEST_F(CalibrateLens, WritesTheTableAndKeepsTheSettingOfTheFile) {
  auto rig = setting(0, 1.001);
  rig.poses = {{"tof", {}, {}, 0, 0, {}}};
  ASSERT_TRUE(calibration_file::write_calibration(take_.path("c.toml"), rig));
  const Outcome done = take_.mixrig(
      "calibrate lens z100.toml,zoom=100,pupil_mm=12.5 z0.toml,zoom=0 z50.toml,zoom=50,pupil_mm=5 "
      "--out c.toml --json r.json");
  ASSERT_EQ(done.status, 0) << done.err;
  const auto read = calibration_file::read_calibration(take_.path("c.toml"));
  ASSERT_TRUE(read) << read.error().context;
  const auto* camera = read->camera("target");
  ASSERT_TRUE(camera != nullptr && camera->lens);
  EXPECT_NEAR(geometry::parameters_of(camera->model)[0], 500.5, 1e-9);
  EXPECT_NE(read->pose("tof"), nullptr);
  EXPECT_NEAR(camera->lens->at({25, 0}).camera.pinhole.fx_px, 500 * std::pow(2, 0.25), 1e-6);
  EXPECT_NEAR(camera->lens->at({100, 0}).pupil_shift_m, 0.0125, 1e-12);
  EXPECT_EQ(camera->lens->nodes()[0].residual_px, 0.25);
  std::ifstream file(take_.path("r.json"));
  const auto report = nlohmann::json::parse(file);
  ASSERT_EQ(report.at("left_out").size(), 1U);
  EXPECT_LT(report.at("left_out")[0].at("max_px").get<double>(), 1e-6);
  EXPECT_NE(done.out.find("left out and predicted"), std::string::npos) << done.out;
}

TEST_F(CalibrateLens, SaysWhatIsWrong) {
  EXPECT_NE(error("z0.toml z50.toml,zoom=50").find("without file or zoom"), std::string::npos);
  EXPECT_NE(error("z0.toml,zoom=x z50.toml,zoom=50").find("is no number"), std::string::npos);
  EXPECT_NE(error("z0.toml,zoom=1,iris=2 z50.toml,zoom=50").find("\"iris\" is unknown"),
            std::string::npos);
  EXPECT_NE(error("z0.toml,zoom=0").find("two nodes or more"), std::string::npos);
  EXPECT_NE(error("z0.toml,zoom=0 z50.toml,zoom=50,focus=1").find("give all or none"),
            std::string::npos);
  EXPECT_NE(error("z0.toml,zoom=0 none.toml,zoom=1").find("none.toml"), std::string::npos);
  EXPECT_NE(error("z0.toml,zoom=0 z50.toml,zoom=50 --camera tof").find("\"tof\" is missing"),
            std::string::npos);
}

}  // namespace
}  // namespace mixrig::test
