// SPDX-License-Identifier: Apache-2.0
#include "host/run/explain/explain.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/box_source.h"

namespace mixrig::session {
namespace {

class ExplainTest : public ::testing::Test {
 protected:
  ExplainTest() {
    session_.source = std::make_unique<test::BoxSource>(5, 12);
    session_.setup = *setup_of(session_.source->info(), std::nullopt);
    session_.backend = {render::Backend::kCpu, 1};
    session_.calibration = {calibration_file::CalibrationOrigin::kFile, "cal.toml", "cal.toml",
                            "named by --calibration"};
  }
  Explanation explained() {
    auto out = explain(session_, 4, {}, clock_, {});
    EXPECT_TRUE(out) << out.error().context;
    return *std::move(out);
  }
  static std::string why(const Explanation& explanation, std::string_view pass) {
    for (const PassLine& line : explanation.passes)
      if (line.name == pass) return line.why;
    return "no such pass";
  }
  Session session_;
  SystemClock clock_;
};

TEST_F(ExplainTest, WithoutABackgroundNothingIsKeyed) {
  const Explanation out = explained();
  EXPECT_EQ(why(out, "key"),
            "not run: the scene has neither background nor capture volume, nothing is foreground");
  EXPECT_EQ(why(out, "light"), "not run: the scene has no object");
  for (const BufferLine& buffer : out.buffers)
    EXPECT_EQ(buffer.name.find("background"), std::string::npos) << buffer.name;
}

TEST_F(ExplainTest, ACaptureVolumeKeysAloneOrCrops) {
  session_.setup.capture_box = render::CaptureBox{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_NE(why(explained(), "key").find("in the capture volume over its floor"),
            std::string::npos);
  EXPECT_EQ(why(explained(), "mix").find("transparent"), std::string::npos);
  session_.setup.backdrop.emplace();
  EXPECT_NE(why(explained(), "mix").find("transparent"), std::string::npos);
  session_.setup.backdrop.reset();
  session_.scene.background.learn = {1, 5};
  EXPECT_NE(why(explained(), "key").find("cropped to the capture volume"), std::string::npos);
}

TEST_F(ExplainTest, ACameraThatMayMoveHasACostOfAMovingFrame) {
  session_.source = std::make_unique<test::BoxSource>(5, 12, true);
  const Explanation moving = explained();
  ASSERT_TRUE(moving.moving_p50_ms);
  EXPECT_GT(*moving.moving_p50_ms, 0.0);
  EXPECT_GT(moving.still_p50_ms, 0.0);
  EXPECT_NE(to_text(moving).find("moving"), std::string::npos);

  session_.scene.pose_source = scene::PoseSource::kIdentity;
  session_.poses.reset();
  const Explanation fixed = explained();
  EXPECT_FALSE(fixed.moving_p50_ms) << "a camera at the origin does not move";
  EXPECT_TRUE(to_json(fixed)["moving_p50_ms"].is_null());
  EXPECT_EQ(fixed.camera, "fixed at the origin of the world");
}

TEST_F(ExplainTest, SaysWhichCalibrationCountsAndWhy) {
  const Explanation out = explained();
  EXPECT_EQ(out.calibration, "cal.toml: named by --calibration");
  EXPECT_NE(to_text(out).find("cal.toml: named by --calibration"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::session
