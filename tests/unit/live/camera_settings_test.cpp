// SPDX-License-Identifier: Apache-2.0
// Settings of running cameras, and rig.toml that keeps them.
#include "host/capture/live/rig/camera_settings.h"

#include <gtest/gtest.h>

#include "hal/fake/fake_camera.h"
#include "host/capture/live/rig/rig_config.h"
#include "host/capture/live/rig/rig_edit.h"
#include "tests/support/progress.h"
#include "tests/support/refusal.h"

namespace mixrig::live {
namespace {

using device::CameraControl;

class CameraSettingsTest : public ::testing::Test {
 protected:
  CameraSettingsTest() {
    EXPECT_TRUE(camera_.set(CameraControl::kGain, 3));
    settings_.follow({{"color", &camera_}, {"side", &plain_}});
  }
  std::optional<double> value(std::size_t index) const {
    const auto cameras = settings_.cameras();
    return cameras.empty() ? std::nullopt : cameras[0].settings[index].value;
  }
  ManualClock clock_;
  fake::FakeCamera camera_{clock_,
                           {.uri = "fake:",
                            .size = {16, 12},
                            .format = device::PixelFormat::kRgb8,
                            .controls = {{CameraControl::kExposure, 0.001, 0.04, 0.001},
                                         {CameraControl::kGain, 1, 8, 1}}}};
  fake::FakeCamera plain_{clock_,
                          {.uri = "fake:", .size = {16, 12}, .format = device::PixelFormat::kRgb8}};
  CameraSettings settings_;
};

TEST_F(CameraSettingsTest, TellsWhatCamerasOfferAndHave) {
  ASSERT_TRUE(test::comes_true([&] { return value(1) == 3; }));
  const auto cameras = settings_.cameras();
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].name, "color");
  EXPECT_EQ(cameras[0].settings[0].range.maximum, 0.04);
  EXPECT_TRUE(cameras[1].settings.empty());
  settings_.end();
  EXPECT_TRUE(settings_.cameras().empty());
  EXPECT_EQ(settings_.set("color", CameraControl::kGain, 2).error().code, ErrorCode::kNotFound);
}

TEST_F(CameraSettingsTest, SetsOneAndKnowsItWhenItReturns) {
  ASSERT_TRUE(settings_.set("color", CameraControl::kExposure, 0.02));
  EXPECT_EQ(value(0), 0.02);
  settings_.end();
  EXPECT_EQ(camera_.get(CameraControl::kExposure).value(), 0.02);
}

TEST_F(CameraSettingsTest, WhatCannotBeIsOneLine) {
  const auto far = settings_.set("color", CameraControl::kExposure, 1);
  EXPECT_EQ(far.error().code, ErrorCode::kUsage);
  EXPECT_NE(far.error().context.find("exposure_ms must be 1 to 40"), std::string::npos)
      << far.error().context;
  EXPECT_EQ(settings_.set("color", CameraControl::kZoom, 1).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(settings_.set("none", CameraControl::kGain, 1).error().code, ErrorCode::kNotFound);
}

/// A camera whose values cannot be read for lack of memory.
class NoMemoryCamera final : public device::Camera {
 public:
  const device::CameraInfo& info() const override { return info_; }
  Result<void> start(device::FrameSink) override { return {}; }
  void stop() override {}
  Result<void> set(CameraControl, double) override { throw std::bad_alloc(); }
  Result<double> get(CameraControl) override { throw std::bad_alloc(); }
  device::StreamHealth health() const override { return {}; }

 private:
  device::CameraInfo info_{.uri = "fake:", .controls = {{CameraControl::kGain, 1, 8, 1}}};
};

TEST_F(CameraSettingsTest, WhatACameraThrowsAnswersWhoWaits) {
  NoMemoryCamera camera;
  settings_.follow({{"color", &camera}});
  EXPECT_TRUE(test::refused(settings_.set("color", CameraControl::kGain, 2), {"no memory is left"},
                            ErrorCode::kIo));
  settings_.follow({{"color", &camera_}});
  EXPECT_TRUE(settings_.set("color", CameraControl::kGain, 2)) << "the next ones can be set";
}

constexpr const char* kRig = R"(format = 1
name = "rig"  # ours

[[camera]]
name = "color"
uri = "v4l2:/dev/video0"
exposure_ms = 5.0  # by the grey card

[[camera]]
uri = "v4l2:/dev/video2"
# the second one has no name of its own

[depth]
uri = "usb:1209:0001"
)";

TEST(RigEdit, AKeyIsChangedOrAddedAndTheRestStays) {
  auto text = with_control(kRig, "rig.toml", "color", CameraControl::kExposure, 0.0125);
  ASSERT_TRUE(text) << to_line(text.error());
  EXPECT_NE(text->find("exposure_ms = 12.5  # by the grey card"), std::string::npos) << *text;
  text = with_control(*text, "rig.toml", "camera2", CameraControl::kZoom, 120);
  ASSERT_TRUE(text) << to_line(text.error());
  text = with_control(*text, "rig.toml", "camera2", CameraControl::kWhiteBalance, 4600);
  ASSERT_TRUE(text) << to_line(text.error());
  const auto rig = parse_rig(*text, "rig.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  EXPECT_EQ(rig->cameras[0].exposure_s, 0.0125);
  EXPECT_EQ(rig->cameras[1].zoom, 120);
  EXPECT_EQ(rig->cameras[1].white_balance_k, 4600);
  EXPECT_FALSE(rig->cameras[0].zoom);
  EXPECT_NE(text->find("# ours"), std::string::npos);
  EXPECT_NE(text->find("# the second one"), std::string::npos);
}

TEST(RigEdit, WhatItCannotChangeItLeaves) {
  EXPECT_EQ(with_control(kRig, "rig.toml", "side", CameraControl::kGain, 1).error().code,
            ErrorCode::kNotFound);
  const char* one_line = "format = 1\ncamera = [{ uri = \"v4l2:/dev/video0\" }]\n";
  EXPECT_EQ(with_control(one_line, "rig.toml", "camera1", CameraControl::kGain, 1).error().code,
            ErrorCode::kFormat);
  EXPECT_FALSE(with_control(kRig, "rig.toml", "color", CameraControl::kWhiteBalance, 1));
  EXPECT_FALSE(with_control("[[camera]\n", "rig.toml", "color", CameraControl::kGain, 1));
}

}  // namespace
}  // namespace mixrig::live
