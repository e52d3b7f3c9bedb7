// SPDX-License-Identifier: Apache-2.0
// `mixrig run` on a studio take whose lens zooms in by a factor of two: once with the lens table of
// its calibration, once with the lens of the first frame. The seed is held out
// (tests/support/seeds.h); the bounds were chosen on seeds below 1000.
#include <gtest/gtest.h>

#include "tests/e2e/command.h"
#include "tests/support/seeds.h"

namespace mixrig::test {
namespace {

class ZoomRun : public CommandTest {
 protected:
  nlohmann::json run(const std::string& scene) const {
    EXPECT_EQ(mixrig("run " + path("take/" + scene) + " --source take:" + path("take") + " --out " +
                     path("out_" + scene) + " --backend cpu --format none --json " +
                     path(scene + ".json")),
              0);
    return report(scene + ".json");
  }
};

TEST_F(ZoomRun, FollowsTheLensByItsTable) {
  ASSERT_EQ(
      studio("take", "--plain --scenario walk --rig kinect2 --seed " +
                         std::to_string(seeds::kWalk) + " --size 320x256 --frames 16 --zoom 2"),
      0);
  const auto zoomed = run("scene_zoom.toml");
  EXPECT_GE(zoomed.at("error").at("key_iou").get<double>(), 0.90);
  EXPECT_LE(zoomed.at("error").at("order_wrong_pct").get<double>(), 5.0);
  EXPECT_LE(zoomed.at("pose").at("slip_px").at("rms").get<double>(), 0.2);
  const auto lens = zoomed.at("lens");
  EXPECT_EQ(lens.at("frames").at("encoded"), 8);
  EXPECT_EQ(lens.at("beyond_background"), 0);
  EXPECT_GE(lens.at("changed").get<int>(), 6);
  const auto fx_px = lens.at("fx_px").get<std::vector<double>>();
  EXPECT_NEAR(fx_px[1] / fx_px[0], 2, 0.15);

  // frames.csv has the view of each frame, which zooms like the true one. The focal length doubles
  // in 0.28 s and is interpolated linearly between samples 20 ms apart: in the middle of z(t) = 3
  // t^2 - 2 t^3 it is off by up to ln 2 * 6 / 0.28^2 * 0.02^2 / 8 = 0.27 %.
  const auto views = column(path("out_scene_zoom.toml/frames.csv"), 10);
  const auto true_views = column(path("take/truth/lens.csv"), 1);
  ASSERT_EQ(views.size(), 8U);
  ASSERT_EQ(true_views.size(), 16U);
  for (std::size_t i = 0; i < views.size(); ++i)
    EXPECT_NEAR(views[i] / true_views[8 + i], 1, 3e-3) << i;

  const auto fixed = run("scene.toml");
  EXPECT_FALSE(fixed.contains("lens"));
  EXPECT_LE(fixed.at("error").at("key_iou").get<double>(), 0.75);
  EXPECT_GE(fixed.at("error").at("order_wrong_pct").get<double>(), 15.0);
  EXPECT_GE(fixed.at("pose").at("slip_px").at("rms").get<double>(), 20.0);
}

}  // namespace
}  // namespace mixrig::test
