// SPDX-License-Identifier: Apache-2.0
// The usb driver with a ToF camera that shows all faults of its link.
#include "hal/linux/tof_usb_camera.h"
#include "tests/board/bench.h"
#include "tests/board/tof_device.h"

namespace mixrig::board {
namespace {

constexpr Size kSize{160, 120};
constexpr double kRate_hz = 25;
SystemClock g_clock;

class TofUsb : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto plugged = port_.plug();
    ASSERT_TRUE(plugged) << to_line(plugged.error());
    ASSERT_TRUE(wait_until([this] {
      auto opened = device::open_tof_usb("1209:0001", g_clock);
      if (opened) camera_ = *std::move(opened);
      return camera_ != nullptr;
    }));
    ASSERT_TRUE(camera_->start(frames_.sink()));
    ASSERT_TRUE(frames_.wait_for_more(3));
  }
  void TearDown() override {
    if (camera_) camera_->stop();
  }

  /// One frame is damaged. The stream must continue, and every frame marked complete must be
  /// correct.
  void check_fault(TofFault fault, std::uint64_t incomplete) {
    const auto before = camera_->health();
    device_.fail_next(fault);
    port_.wake();
    ASSERT_TRUE(frames_.wait_for_more(10));
    const auto after = camera_->health();
    EXPECT_EQ(after.incomplete - before.incomplete, incomplete);
    EXPECT_EQ(after.state, device::DeviceState::kStreaming);
    measured("%llu incomplete, %llu link errors, %llu lost, %llu returns",
             static_cast<unsigned long long>(after.incomplete - before.incomplete),
             static_cast<unsigned long long>(after.link_errors - before.link_errors),
             static_cast<unsigned long long>(after.lost - before.lost),
             static_cast<unsigned long long>(after.returns - before.returns));
  }

  TofDevice device_{kSize, kRate_hz};
  VhciPort port_{1, device_};
  std::unique_ptr<device::DepthCamera> camera_;
  Frames frames_;
};

TEST_F(TofUsb, FramesAreWhatTheSensorSaw) {
  ASSERT_TRUE(frames_.wait_for_more(50));
  camera_->stop();
  const auto frame = frames_.last();
  const auto step = [&](int x, int y) {
    const std::size_t at = 2 * static_cast<std::size_t>(y * kSize.width + x);
    return frame->bytes[at] | frame->bytes[at + 1] << 8;
  };
  EXPECT_EQ(step(0, 0), kTofCodeBase_steps + static_cast<int>(frame->sequence) - 1);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 1; x < kSize.width; ++x) ASSERT_EQ(step(x, y), TofDevice::step_at(x, y));
  EXPECT_EQ(frame->amplitude[0] | frame->amplitude[1] << 8, 900);
  EXPECT_NEAR(camera_->depth_health().temperature_c, 41.5, 0.01);
  const auto seen = frames_.seen();
  const auto health = camera_->health();
  EXPECT_EQ(health.lost + health.incomplete + health.link_errors, 0U);
  const double rate_hz = static_cast<double>(seen.size() - 1) /
                         seconds(seen.back().device_time - seen.front().device_time);
  EXPECT_NEAR(rate_hz, kRate_hz, 0.5);
  measured("%zu frames, %.2f Hz", seen.size(), rate_hz);
}

TEST_F(TofUsb, RecoversFromALostPacket) { check_fault(TofFault::kLosePacket, 1); }
TEST_F(TofUsb, RecoversFromATruncatedFrame) { check_fault(TofFault::kTruncate, 1); }
TEST_F(TofUsb, RecoversFromRowsOutOfRange) { check_fault(TofFault::kRowsBeyond, 1); }
TEST_F(TofUsb, RecoversFromADamagedPayload) { check_fault(TofFault::kDamage, 1); }

TEST_F(TofUsb, RecoversFromAStalledPipe) {
  device_.fail_next(TofFault::kStall);
  port_.wake();
  const HostTime begin = g_clock.now();
  ASSERT_TRUE(wait_until([this] { return camera_->health().returns == 1; }));
  ASSERT_TRUE(frames_.wait_for_more(3));
  const double back_s = seconds(frames_.last()->received - begin);
  EXPECT_LT(back_s, seconds(kRecovery));
  EXPECT_EQ(camera_->health().link_errors, 1U);
  measured("frames again after %.2f s", back_s);
}

TEST_F(TofUsb, DeliversAgainAfterEachOfThreeReconnects) {
  for (std::uint64_t pull = 1; pull <= 3; ++pull) {
    port_.unplug();
    ASSERT_TRUE(
        wait_until([this] { return camera_->health().state == device::DeviceState::kLost; }));
    ASSERT_TRUE(port_.plug());
    const HostTime plugged = g_clock.now();
    ASSERT_TRUE(wait_until([&] { return camera_->health().returns == pull; }));
    ASSERT_TRUE(frames_.wait_for_more(3));
    const double back_s = seconds(frames_.last()->received - plugged);
    EXPECT_LT(back_s, seconds(kRecovery));
    measured("pull %d: frames again %.2f s after it was plugged in", static_cast<int>(pull),
             back_s);
  }
}

}  // namespace
}  // namespace mixrig::board
