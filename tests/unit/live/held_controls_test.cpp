// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/held_controls.h"

#include <gtest/gtest.h>

#include "hal/fake/fake_camera.h"

namespace mixrig::live {
namespace {

constexpr std::size_t kExposureAt = 0, kGainAt = 1, kFocusAt = 2;

class HeldControlsTest : public ::testing::Test {
 protected:
  ManualClock clock_;
  fake::FakeCamera camera_{clock_,
                           {.uri = "fake:",
                            .size = {16, 12},
                            .format = device::PixelFormat::kRgb8,
                            .controls = {{device::CameraControl::kExposure, 0.001, 0.04, 0.001},
                                         {device::CameraControl::kGain, 1, 8, 1}}}};
  CameraConfig config_;
};

TEST_F(HeldControlsTest, HoldsThePresentValueOfWhatRigTomlLeavesOpen) {
  ASSERT_TRUE(camera_.set(device::CameraControl::kExposure, 0.02));
  config_.gain = 4;
  EXPECT_TRUE(adjusts_itself(config_, camera_.info()));
  const HeldControls held = hold_controls(config_, camera_, {});
  EXPECT_EQ(held[kExposureAt], 0.02);
  EXPECT_FALSE(held[kGainAt]) << "rig.toml fixes it";
  EXPECT_FALSE(held[kFocusAt]) << "the camera does not have it";
  config_.exposure_s = 0.01;
  EXPECT_FALSE(adjusts_itself(config_, camera_.info()));
}

TEST_F(HeldControlsTest, GoesOnWithTheValuesOfAnEarlierRun) {
  HeldControls earlier;
  earlier[kExposureAt] = 0.03, earlier[kGainAt] = 99;  // of another camera: out of range
  const auto read = parse_held(held_text(earlier), "controls.toml");
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_EQ(*read, earlier);
  const HeldControls held = hold_controls(config_, camera_, *read);
  EXPECT_EQ(*camera_.get(device::CameraControl::kExposure), 0.03);
  EXPECT_EQ(held[kExposureAt], 0.03);
  EXPECT_FALSE(held[kGainAt]);
}

TEST_F(HeldControlsTest, RefusesAnotherFile) {
  EXPECT_FALSE(parse_held("format = 2\n", "c"));
  EXPECT_FALSE(parse_held("format = 1\nzoom = 3\n", "c"));
  EXPECT_FALSE(parse_held("format = 1\nexposure = \"long\"\n", "c"));
}

}  // namespace
}  // namespace mixrig::live
