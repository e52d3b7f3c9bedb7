// SPDX-License-Identifier: Apache-2.0
// The Kinect v2 driver, with its decoder, on an emulated device that replays packets: depth and
// colour, then one fault at a time.
#include "extras/kinect2/kinect2_camera.h"

#include <atomic>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "extras/kinect2/emulated_kinect2.h"
#include "extras/kinect2/kinect2_depth.h"
#include "tests/support/kinect2_answers.h"
#include "tests/support/kinect2_pictures.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr double kWall_m = 2.5;

/// A patch at one distance of the light's way; the rest is dark.
const Kinect2Pictures& wall() {
  static const Kinect2Pictures pictures = [] {
    Kinect2Pictures p;
    constexpr std::array<double, 3> kRanges_m{1.875, 9.375, 1.25}, kLight{1134, 1500, 930};
    for (int n = 0; n < 9; ++n) {
      const double phase = 2 * std::numbers::pi * (kWall_m / kRanges_m[n / 3] + n % 3 / 3.0);
      const int code = kinect2_code(kLight[n / 3] * std::cos(phase));
      for (int y = 100; y < 120; ++y)
        for (int x = 240; x < 272; ++x) p.put(n, x, y, code);
    }
    return p;
  }();
  return pictures;
}

Bytes raw_frame(std::uint32_t number) {
  Bytes all;
  for (std::uint32_t n = 0; n < 10; ++n) {
    const Bytes one = kinect2_packet(wall().bytes.data() + n * device::kKinect2PictureBytes, n,
                                     number, 266 * number);
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

Bytes color_frame(std::uint32_t number) {
  Bytes jpeg(40000, 0x22);
  jpeg.push_back(0xFF), jpeg.push_back(0xD9);
  return kinect2_color_packet(jpeg, number, 266 * number);
}

class Kinect2Camera : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened =
        device::open_kinect2(device_.pipes(), "kinect2:test", clock_, device::make_kinect2_decoder);
    ASSERT_TRUE(opened) << to_line(opened.error());
    depth_ = device::kinect2_depth_camera(*opened);
    color_ = device::kinect2_color_camera(*std::move(opened));
  }
  void start() {
    ASSERT_TRUE(depth_->start([this](const device::FramePtr& f) {
      const std::lock_guard lock(mutex_);
      last_ = f;
    }));
  }
  void send(int lost = -1, int cut = -1) {
    clock_.advance(33ms);
    device_.send_depth(raw_frame(++frame_), lost, cut);
  }
  bool frames(std::uint64_t count) {
    return comes_true([&] { return depth_->health().frames >= count; });
  }
  device::FramePtr last() {
    const std::lock_guard lock(mutex_);
    return last_;
  }

  ThreadedClock clock_;
  device::EmulatedKinect2 device_{kinect2_answers()};
  std::unique_ptr<device::DepthCamera> depth_;
  std::unique_ptr<device::Camera> color_;
  std::uint32_t frame_ = 0;
  std::mutex mutex_;
  device::FramePtr last_;
};

TEST_F(Kinect2Camera, DeliversDistancesAmplitudeAndConfidence) {
  EXPECT_EQ(depth_->info().serial, "000000000001");
  EXPECT_NE(depth_->info().model.find("4.3.3911.7"), std::string::npos);
  ASSERT_NO_FATAL_FAILURE(start());
  send();
  ASSERT_TRUE(frames(1));
  const auto frame = last();
  EXPECT_EQ(frame->flags, device::kFrameOk);
  EXPECT_EQ(frame->device_time, DeviceTime(33250us));
  Image<float> distance_m;
  ASSERT_TRUE(device::to_metres(*frame, depth_->depth(), distance_m));
  EXPECT_NEAR(distance_m.at(255, 110), kWall_m, 0.003);
  EXPECT_EQ(distance_m.at(100, 110), 0);
  ASSERT_EQ(frame->amplitude.size(), 2U * 512 * 424);
  EXPECT_NEAR(
      frame->amplitude[2 * (110 * 512 + 255)] + 256 * frame->amplitude[2 * (110 * 512 + 255) + 1],
      6000, 200);
  ASSERT_EQ(frame->confidence.size(), 2U * 512 * 424);
  EXPECT_GT(depth_->depth_health().mean_amplitude, 0);
}

TEST_F(Kinect2Camera, ColourComesBesideDepthAndEitherStopsAlone) {
  ASSERT_NO_FATAL_FAILURE(start());
  device::FramePtr picture;
  std::mutex mutex;
  ASSERT_TRUE(color_->start([&](const device::FramePtr& f) {
    const std::lock_guard lock(mutex);
    picture = f;
  }));
  EXPECT_FALSE(color_->start([](const device::FramePtr&) {}));
  EXPECT_TRUE(color_->info().mirrored);
  device_.send_color(color_frame(7));
  ASSERT_TRUE(comes_true([&] { return color_->health().frames == 1; }));
  EXPECT_EQ(picture->format, device::PixelFormat::kMjpeg);
  EXPECT_EQ(picture->sequence, 7U);
  EXPECT_EQ(picture->bytes.back(), 0xD9);
  EXPECT_EQ(picture->exposure, 8ms);
  depth_->stop();
  EXPECT_TRUE(device_.streaming());
  device_.send_color(color_frame(8));
  ASSERT_TRUE(comes_true([&] { return color_->health().frames == 2; }));
  color_->stop();
  EXPECT_FALSE(device_.streaming());
  EXPECT_EQ(device_.starts(), 1);
  EXPECT_EQ(color_->set(device::CameraControl::kGain, 1).error().code, ErrorCode::kUnsupported);
}

TEST_F(Kinect2Camera, ALostPacketIsAnIncompleteFrameWithoutDepth) {
  ASSERT_NO_FATAL_FAILURE(start());
  send();
  send(/*lost=*/44);
  send();
  ASSERT_TRUE(frames(3));
  EXPECT_EQ(depth_->health().incomplete, 1U);
  EXPECT_EQ(depth_->health().link_errors, 1U);
  EXPECT_EQ(depth_->health().lost, 0U);
}

TEST_F(Kinect2Camera, ATruncatedPacketIsALinkErrorAndAnIncompleteFrame) {
  ASSERT_NO_FATAL_FAILURE(start());
  send(-1, /*cut=*/5);
  send();
  ASSERT_TRUE(frames(2));
  EXPECT_EQ(depth_->health().incomplete, 1U);
  EXPECT_GE(depth_->health().link_errors, 1U);
}

TEST_F(Kinect2Camera, MissingFramesAreCountedByTheDevicesCounter) {
  ASSERT_NO_FATAL_FAILURE(start());
  send();
  frame_ += 2;
  send();
  ASSERT_TRUE(frames(2));
  EXPECT_EQ(depth_->health().lost, 2U);
  EXPECT_EQ(last()->flags, device::kFrameAfterGap);
}

TEST_F(Kinect2Camera, UnpluggedAndBackItStreamsAgain) {
  ASSERT_NO_FATAL_FAILURE(start());
  send();
  ASSERT_TRUE(frames(1));
  device_.unplug();
  ASSERT_TRUE(comes_true([&] { return depth_->health().state == device::DeviceState::kLost; }));
  device_.replug();
  ASSERT_TRUE(comes_true([&] { return depth_->health().returns == 1; }));
  frame_ = 0;
  send();
  ASSERT_TRUE(frames(2));
  EXPECT_EQ(last()->flags, device::kFrameRestarted);
  EXPECT_EQ(depth_->health().lost, 0U);
  EXPECT_EQ(device_.starts(), 2);
}

TEST_F(Kinect2Camera, AStallAndSilenceStartItAgain) {
  ASSERT_NO_FATAL_FAILURE(start());
  device_.stall();
  ASSERT_TRUE(comes_true([&] { return depth_->health().returns == 1; }));
  EXPECT_EQ(depth_->health().link_errors, 1U);
  send();
  ASSERT_TRUE(frames(1));
  clock_.advance(1500ms);
  ASSERT_TRUE(comes_true([&] { return depth_->health().returns == 2; }));
}

TEST(Kinect2Open, AnswersThatAreNotValidAreRefused) {
  ThreadedClock clock;
  auto wrong = kinect2_answers();
  wrong.phase_offsets.resize(1000);
  device::EmulatedKinect2 device(wrong);
  auto opened =
      device::open_kinect2(device.pipes(), "kinect2:test", clock, device::make_kinect2_decoder);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kDevice);
  device::EmulatedKinect2 silent(kinect2_answers());
  silent.leave_commands_open();
  opened =
      device::open_kinect2(silent.pipes(), "kinect2:test", clock, device::make_kinect2_decoder);
  ASSERT_FALSE(opened);
}

}  // namespace
}  // namespace mixrig::test
