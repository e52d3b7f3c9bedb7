// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/hal_device/camera_contract.h"

#include "hal/fake/fake_camera.h"

namespace mixrig::test {
namespace {

device::CameraInfo small_camera() {
  return {.uri = "fake:camera",
          .model = "fake",
          .size = {8, 4},
          .format = device::PixelFormat::kGray8,
          .stamp_clock = device::StampClock::kHost,
          .controls = {{device::CameraControl::kExposure, 0.0001, 0.04, 0.0001}}};
}

CameraUnderTest fake_camera() {
  static ManualClock clock;
  auto camera = std::make_unique<fake::FakeCamera>(clock, small_camera());
  auto* raw = camera.get();
  return {std::move(camera), [raw](int count) {
            for (int i = 0; i < count; ++i) {
              clock.advance(std::chrono::milliseconds(40));
              raw->emit();
            }
          }};
}

INSTANTIATE_TEST_SUITE_P(Fake, CameraContract, ::testing::Values(CameraMaker{"fake", fake_camera}),
                         [](const auto& maker) { return maker.param.name; });

class FakeCameraFaults : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(camera_.start([this](const device::FramePtr& frame) { frames_.push_back(frame); }));
  }
  ManualClock clock_;
  fake::FakeCamera camera_{clock_, small_camera(), 3};
  std::vector<device::FramePtr> frames_;
};

TEST_F(FakeCameraFaults, LostFramesAreCountedAndFlagged) {
  camera_.emit();
  camera_.drop_next(2);
  for (int i = 0; i < 3; ++i) camera_.emit();
  ASSERT_EQ(frames_.size(), 2U);
  EXPECT_EQ(frames_[1]->flags, device::kFrameAfterGap);
  EXPECT_EQ(frames_[1]->sequence, 4U);
  EXPECT_EQ(camera_.health().lost, 2U);
}

TEST_F(FakeCameraFaults, FramesWithoutAFreeBufferAreCountedAsOverrun) {
  for (int i = 0; i < 5; ++i) camera_.emit();
  EXPECT_EQ(frames_.size(), 3U);
  EXPECT_EQ(camera_.health().overrun, 2U);
  frames_.clear();
  camera_.emit();
  ASSERT_EQ(frames_.size(), 1U);
  EXPECT_EQ(frames_[0]->flags & device::kFrameAfterGap, device::kFrameAfterGap);
}

TEST_F(FakeCameraFaults, DeliversAgainAfterUnplugging) {
  camera_.emit();
  camera_.unplug();
  camera_.emit();
  EXPECT_EQ(camera_.health().state, device::DeviceState::kLost);
  camera_.replug();
  camera_.emit();
  ASSERT_EQ(frames_.size(), 2U);
  EXPECT_EQ(frames_[1]->flags, device::kFrameRestarted);
  EXPECT_EQ(camera_.health().returns, 1U);
  EXPECT_EQ(camera_.health().lost, 0U) << "a new counter is not a gap";
}

TEST_F(FakeCameraFaults, DamagedFrameIsFlagged) {
  camera_.damage_next();
  camera_.emit();
  EXPECT_EQ(frames_[0]->flags, device::kFrameIncomplete);
  EXPECT_EQ(camera_.health().incomplete, 1U);
}

}  // namespace
}  // namespace mixrig::test
