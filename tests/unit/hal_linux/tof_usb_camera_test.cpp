// SPDX-License-Identifier: Apache-2.0
// The USB ToF driver on a pipe that the test fills: the contract, then one fault at a time.
#include "hal/linux/tof_usb_camera.h"

#include "tests/support/fake_bulk.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/throw_in.h"
#include "tests/support/tof_stream.h"
#include "tests/unit/hal_device/depth_camera_contract.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;

device::TofDescription description() {
  device::TofDescription d;
  d.size = {32, 24};
  d.rate_hz = 25;
  d.amplitude = true;
  d.depth.metres_per_step = 0.00025;
  return d;
}

/// A camera on a fake device, and the frames that it delivered.
struct Rig {
  ThreadedClock clock;
  FakeTofDevice device{description(), clock};
  std::uint32_t frame = 0;

  std::unique_ptr<device::DepthCamera> open() {
    auto camera = device::open_tof(std::make_unique<FakeBulk>(device), "usb:fake", clock);
    EXPECT_TRUE(camera);
    return camera ? *std::move(camera) : nullptr;
  }
  void send_frame(int leave_out = -1, std::size_t cut = 0) {
    int number = 0;
    clock.advance(40ms);
    ++frame;
    for (auto packet : tof_frame(description(), frame, 40'000ULL * frame)) {
      if (number++ == leave_out) {
        if (cut == 0) continue;
        packet.resize(cut);
      }
      device.send(std::move(packet));
    }
  }
};

DepthCameraUnderTest make_usb_camera() {
  auto rig = std::make_shared<Rig>();
  DepthCameraUnderTest out;
  out.camera = rig->open();
  auto* camera = out.camera.get();
  out.expose = [rig, camera](int count) {
    const auto wanted = camera->health().frames + static_cast<std::uint64_t>(count);
    for (int i = 0; i < count; ++i) rig->send_frame();
    if (camera->health().state == device::DeviceState::kStopped) return;
    EXPECT_TRUE(comes_true([&] { return camera->health().frames >= wanted; }));
  };
  out.keep = rig;
  return out;
}

INSTANTIATE_TEST_SUITE_P(Usb, DepthCameraContract,
                         ::testing::Values(DepthCameraMaker{"usb", make_usb_camera}),
                         [](const auto& maker) { return maker.param.name; });

class TofUsbFaults : public ::testing::Test {
 protected:
  void SetUp() override {
    camera_ = rig_.open();
    ASSERT_TRUE(camera_->start([this](const device::FramePtr& frame) {
      const std::lock_guard lock(mutex_);
      flags_.push_back(frame->flags);
    }));
    ASSERT_TRUE(frames_come(3));
  }
  /// Sends frames until `count` more were published.
  bool frames_come(std::uint64_t count) {
    const std::uint64_t wanted = camera_->health().frames + count;
    for (std::uint64_t i = 0; i < count; ++i) rig_.send_frame();
    return comes_true([&] { return camera_->health().frames >= wanted; });
  }
  std::uint32_t last_flags() {
    const std::lock_guard lock(mutex_);
    return flags_.back();
  }
  Rig rig_;
  std::mutex mutex_;
  std::vector<std::uint32_t> flags_;
  std::unique_ptr<device::DepthCamera> camera_;
};

TEST_F(TofUsbFaults, DeliversAgainWithinTwoSecondsAfterAReconnect) {
  rig_.device.unplug();
  ASSERT_TRUE(comes_true([&] { return camera_->health().state == device::DeviceState::kLost; }));
  rig_.device.replug();
  ASSERT_TRUE(comes_true([&] { return rig_.device.streaming(); }));
  EXPECT_LT(rig_.device.recovery(), 2s);
  rig_.frame = 0;  // the device counts from 0 again
  ASSERT_TRUE(frames_come(1));
  EXPECT_EQ(last_flags() & device::kFrameRestarted, device::kFrameRestarted);
  ASSERT_TRUE(frames_come(2));
  EXPECT_EQ(last_flags(), device::kFrameOk);
  EXPECT_EQ(camera_->health().returns, 1U);
  EXPECT_EQ(camera_->health().lost, 0U) << "a new counter is not a gap";
}

TEST_F(TofUsbFaults, AStalledPipeIsClearedAndCounted) {
  rig_.device.stall();
  ASSERT_TRUE(comes_true([&] { return camera_->health().returns == 1; }));
  EXPECT_EQ(camera_->health().link_errors, 1U);
  EXPECT_EQ(rig_.device.starts(), 2);
  EXPECT_TRUE(frames_come(2));
}

TEST_F(TofUsbFaults, APipeWithoutBytesIsRestartedOnce) {
  rig_.clock.advance(1500ms);
  ASSERT_TRUE(comes_true([&] { return camera_->health().returns == 1; }));
  EXPECT_EQ(camera_->health().link_errors, 1U);
  // Still no bytes: the camera may wait for its trigger, which is no fault.
  rig_.clock.advance(5s);
  ASSERT_TRUE(frames_come(1));
  EXPECT_EQ(camera_->health().returns, 1U);
}

TEST_F(TofUsbFaults, ALostPacketIsAnIncompleteFrame) {
  rig_.send_frame(/*leave_out=*/0);
  ASSERT_TRUE(frames_come(1));
  ASSERT_TRUE(comes_true([&] { return camera_->health().incomplete == 1; }));
  EXPECT_EQ(camera_->health().lost, 0U);
}

TEST_F(TofUsbFaults, ATruncatedPacketIsALinkErrorAndAnIncompleteFrame) {
  rig_.send_frame(/*leave_out=*/1, /*cut=*/100);
  ASSERT_TRUE(frames_come(1));
  ASSERT_TRUE(comes_true([&] { return camera_->health().incomplete == 1; }));
  EXPECT_EQ(camera_->health().link_errors, 1U);
}

TEST_F(TofUsbFaults, RowsOutOfRangeAreALinkErrorAndNothingIsWrittenBeyondThePicture) {
  auto packet = tof_packet(description(), device::TofKind::kDistance, rig_.frame + 1, 0, 8, 1);
  auto header = device::pack_tof_header({.kind = device::TofKind::kDistance,
                                         .frame = rig_.frame + 1,
                                         .first_row = 23,
                                         .rows = 8,
                                         .size = description().size,
                                         .payload_bytes = 8 * 32 * 2});
  std::copy(header.begin(), header.end(), packet.begin());
  rig_.device.send(packet);
  ASSERT_TRUE(frames_come(2));
  EXPECT_EQ(camera_->health().link_errors, 1U);
  EXPECT_EQ(camera_->health().incomplete, 0U);
}

TEST(TofUsbThread, WhatItThrowsIsAFailureOfTheCamera) {
  Rig rig;
  const auto camera = rig.open();
  const ThrowIn thrown("usb");
  ASSERT_TRUE(camera->start([](const device::FramePtr&) {}));
  EXPECT_TRUE(comes_true([&] { return camera->health().state == device::DeviceState::kFailed; }));
  camera->stop();
}

TEST(TofUsbOpen, MalformedIdsAreRefused) {
  SystemClock clock;
  for (const char* id : {"", "1209", "1209:", ":0001", "1209:0001x", "12345:1", "g:1"}) {
    const auto camera = device::open_tof_usb(id, clock);
    ASSERT_FALSE(camera) << id;
    EXPECT_EQ(camera.error().code, ErrorCode::kUsage) << id;
  }
}

TEST(TofUsbOpen, ADamagedDescriptionIsRefused) {
  SteppedClock clock;
  auto wrong = description();
  wrong.size = {5000, 24};
  FakeTofDevice device(wrong, clock);
  const auto camera = device::open_tof(std::make_unique<FakeBulk>(device), "usb:fake", clock);
  ASSERT_FALSE(camera);
  EXPECT_EQ(camera.error().code, ErrorCode::kDevice);
}

}  // namespace
}  // namespace mixrig::test
