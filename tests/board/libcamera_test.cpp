// SPDX-License-Identifier: Apache-2.0
// The libcamera driver on the kernel's vimc, a simulated sensor with an image processor: the
// library runs its handler and its algorithms module for vimc.
#include "extras/libcamera/libcamera_camera.h"
#include "tests/board/bench.h"

namespace mixrig::board {
namespace {

constexpr Size kVimcSize{480, 360};
SystemClock g_libcamera_clock;

class Libcamera : public ::testing::Test {
 protected:
  void SetUp() override {
    if (run("insmod /host/modules/vimc.ko && udevadm settle").status != 0)
      GTEST_SKIP() << "no vimc.ko";
    auto opened = device::open_libcamera(
        "any", {.size = kVimcSize, .format = device::PixelFormat::kRgb8}, g_libcamera_clock);
    ASSERT_TRUE(opened) << to_line(opened.error());
    camera_ = *std::move(opened);
  }
  void TearDown() override {
    camera_.reset();
    (void)run("rmmod vimc && udevadm settle");
  }
  std::unique_ptr<device::Camera> camera_;
  Frames frames_;
};

TEST_F(Libcamera, ASimulatedSensorStreamsInTheFormatAndSizeAskedForWithTheKernelsStamps) {
  EXPECT_EQ(device::list_libcamera().size(), 1U);
  EXPECT_EQ(camera_->info().size, kVimcSize);
  EXPECT_EQ(camera_->info().format, device::PixelFormat::kRgb8);
  EXPECT_EQ(camera_->info().stamp_clock, device::StampClock::kHost);
  ASSERT_TRUE(camera_->start(frames_.sink()));
  EXPECT_FALSE(camera_->start(frames_.sink()));
  ASSERT_TRUE(frames_.wait_for_more(30));
  camera_->stop();
  const auto seen = frames_.seen();
  for (std::size_t i = 1; i < seen.size(); ++i) {
    EXPECT_GT(seen[i].sequence, seen[i - 1].sequence);
    EXPECT_GT(seen[i].device_time, seen[i - 1].device_time);
    EXPECT_LE(seen[i].device_time.time_since_epoch(), seen[i].received.time_since_epoch());
  }
  EXPECT_EQ(frames_.last()->bytes.size(), 3 * kVimcSize.area());
  EXPECT_EQ(frames_.last()->flags & device::kFrameIncomplete, 0U);
  measured("%s: %zu frames, %.2f Hz, %llu lost", camera_->info().model.c_str(), seen.size(),
           static_cast<double>(seen.size() - 1) /
               seconds(seen.back().device_time - seen.front().device_time),
           static_cast<unsigned long long>(camera_->health().lost));
  ASSERT_TRUE(camera_->start(frames_.sink())) << "once more";
  ASSERT_TRUE(frames_.wait_for_more(3));
  EXPECT_EQ(camera_->set(device::CameraControl::kFocus, 3).error().code, ErrorCode::kUnsupported);
}

TEST_F(Libcamera, AMissingCameraASizeAndATriggerAreRefusedInOneLine) {
  camera_.reset();
  const auto missing = device::open_libcamera("nobody", {}, g_libcamera_clock);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(to_line(missing.error()).find("vimc"), std::string::npos) << "tells what there is";
  EXPECT_FALSE(device::open_libcamera("any", {.size = {7, 5}}, g_libcamera_clock));
  EXPECT_FALSE(device::open_libcamera("any", {.hardware_trigger = true}, g_libcamera_clock));
}

// A suite of its own, so that it runs in its own process: the library's thread goes on at full
// load.
class LibcameraSilence : public Libcamera {};

// libcamera's handler of vimc (0.0.3) does not report that its device has vanished, unlike that of
// USB cameras, and stop() would end the process.
TEST_F(LibcameraSilence, ACameraThatFallsSilentIsLostAndCanBeStopped) {
  ASSERT_TRUE(camera_->start(frames_.sink()));
  ASSERT_TRUE(frames_.wait_for_more(5));
  ASSERT_EQ(run("echo vimc.0 >/sys/bus/platform/drivers/vimc/unbind").status, 0);
  const HostTime gone = g_libcamera_clock.now();
  EXPECT_TRUE(wait_until([&] { return camera_->health().state == device::DeviceState::kLost; }));
  measured("lost after %.2f s", seconds(g_libcamera_clock.now() - gone));
  camera_->stop();
  EXPECT_EQ(camera_->health().state, device::DeviceState::kStopped);
  EXPECT_FALSE(camera_->start(frames_.sink())) << "it is still held";
}

}  // namespace
}  // namespace mixrig::board
