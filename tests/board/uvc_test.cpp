// SPDX-License-Identifier: Apache-2.0
// The v4l2 driver and the kernel's uvcvideo on a USB camera: controls, triggers, unplugging.
#include "hal/linux/v4l2/v4l2_camera.h"
#include "tests/board/bench.h"
#include "tests/board/nodes.h"

namespace mixrig::board {
namespace {

SystemClock g_clock;

device::StreamRequest request(bool triggered = false) {
  return {.size = {320, 180},
          .format = device::PixelFormat::kYuyv,
          .rate_hz = 30,
          .hardware_trigger = triggered};
}

TEST(Uvc, ExposureGainFocusAndWhiteBalanceReachTheCamera) {
  UvcBench bench;
  ASSERT_TRUE(bench.plug());
  auto camera = device::V4l2Camera::open(bench.node, request(), g_clock);
  ASSERT_TRUE(camera) << to_line(camera.error());
  using device::CameraControl;
  ASSERT_TRUE((*camera)->set(CameraControl::kExposure, 0.0125));
  ASSERT_TRUE((*camera)->set(CameraControl::kFocus, 55));
  ASSERT_TRUE((*camera)->set(CameraControl::kGain, 7));
  ASSERT_TRUE((*camera)->set(CameraControl::kWhiteBalance, 5200));
  EXPECT_EQ(bench.device.value(1, 2), 1);    // manual exposure
  EXPECT_EQ(bench.device.value(1, 4), 125);  // in units of 0.1 ms
  EXPECT_EQ(bench.device.value(1, 6), 55);
  EXPECT_EQ(bench.device.value(2, 4), 7);
  EXPECT_EQ(bench.device.value(2, 10), 5200);
}

TEST(Uvc, KeepsItsRateAndSettingsOverThreeReconnects) {
  UvcBench bench;
  ASSERT_TRUE(bench.plug());
  auto camera = device::V4l2Camera::open(bench.node, request(), g_clock);
  ASSERT_TRUE(camera) << to_line(camera.error());
  ASSERT_TRUE((*camera)->set(device::CameraControl::kExposure, 0.02));
  Frames frames;
  ASSERT_TRUE((*camera)->start(frames.sink()));
  for (std::uint64_t pull = 1; pull <= 3; ++pull) {
    ASSERT_TRUE(frames.wait_for_more(10));
    bench.port.unplug();
    ASSERT_TRUE(
        wait_until([&] { return (*camera)->health().state == device::DeviceState::kLost; }));
    ASSERT_TRUE(bench.port.plug());
    ASSERT_TRUE(wait_until([&] { return has_node(bench.node); }));
    const HostTime back = g_clock.now();
    ASSERT_TRUE(wait_until([&] { return (*camera)->health().returns == pull; }));
    ASSERT_TRUE(frames.wait_for_more(1));
    const double wait_s = seconds(frames.last()->received - back);
    EXPECT_LT(wait_s, seconds(kRecovery));
    EXPECT_EQ(bench.device.value(1, 4), 200) << "the exposure was not set again";
    measured("pull %d: a frame %.2f s after the node was back", static_cast<int>(pull), wait_s);
  }
  ASSERT_TRUE(frames.wait_for_more(30));
  (*camera)->stop();
  const auto seen = frames.seen();
  const auto& last = seen.back();
  const auto& before = seen[seen.size() - 30];
  const double rate_hz = 29 / seconds(last.device_time - before.device_time);
  EXPECT_NEAR(rate_hz, 30, 0.6);
  measured("%.2f Hz after the last one", rate_hz);
}

TEST(Uvc, ATriggeredCameraDeliversOnePicturePerEdge) {
  UvcBench bench;
  ASSERT_TRUE(bench.plug());
  const auto mapped = map_trigger_control(bench.node);
  ASSERT_TRUE(mapped) << to_line(mapped.error());
  auto camera = device::V4l2Camera::open(bench.node, request(true), g_clock);
  ASSERT_TRUE(camera) << to_line(camera.error());
  EXPECT_TRUE((*camera)->info().hardware_trigger);
  Frames frames;
  ASSERT_TRUE((*camera)->start(frames.sink()));
  g_clock.sleep_until(g_clock.now() + 200ms);
  EXPECT_EQ(frames.seen().size(), 0U) << "it did not wait for an edge";
  for (std::uint32_t edge = 0; edge < 20; ++edge) {
    const HostTime at = g_clock.now();
    bench.device.fire(edge);
    bench.port.wake();
    ASSERT_TRUE(wait_until([&] { return frames.seen().size() == edge + 1; }));
    const double late_ms =
        milliseconds(frames.last()->device_time.time_since_epoch() - at.time_since_epoch());
    EXPECT_GE(late_ms, 0);
    EXPECT_LT(late_ms, 10);
  }
  (*camera)->stop();
  EXPECT_EQ(frames.seen().size(), 20U);
}

}  // namespace
}  // namespace mixrig::board
