// SPDX-License-Identifier: Apache-2.0
// The V4L2 driver against a node whose ioctl() this program answers itself.
#include "hal/linux/v4l2/v4l2_camera.h"

#include <condition_variable>
#include <mutex>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>

#include "hal/linux/v4l2/realsense_unit.h"
#include "tests/support/progress.h"
#include "tests/support/realsense_answer.h"
#include "tests/support/throw_in.h"
#include "tests/unit/hal_linux/fake_v4l2.h"

namespace mixrig::test {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

struct Got {
  Bytes bytes;
  device::PixelFormat format{};
  std::size_t stride_bytes = 0;
  std::uint32_t flags = 0;
  int memory_fd = -1;
};

/// Everything that a camera sends until `count` frames came.
std::vector<Got> take(device::V4l2Camera& camera, std::size_t count) {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Got> got;
  const auto started = camera.start([&](const device::FramePtr& frame) {
    const std::lock_guard lock(mutex);
    got.push_back({{frame->bytes.begin(), frame->bytes.end()},
                   frame->format,
                   frame->stride_bytes,
                   frame->flags,
                   frame->memory.fd});
    changed.notify_all();
  });
  EXPECT_TRUE(started) << to_line(started.error());
  std::unique_lock lock(mutex);
  EXPECT_TRUE(changed.wait_for(lock, 60s, [&] { return got.size() >= count; }));
  lock.unlock();
  camera.stop();
  return got;
}

class V4l2Camera : public ::testing::Test {
 protected:
  std::unique_ptr<device::V4l2Camera> open() {
    auto camera = device::V4l2Camera::open(node_.path(), {}, clock_);
    EXPECT_TRUE(camera) << to_line(camera.error());
    return camera ? *std::move(camera) : nullptr;
  }
  FakeV4l2 node_;
  SystemClock clock_;
};

TEST_F(V4l2Camera, ASinglePlanarNodeTellsItsColoursAndSendsItsBytes) {
  node_.code = V4L2_PIX_FMT_YUYV;
  node_.size = {4, 2};
  node_.planes = {{8, 16}};
  node_.colorspace = V4L2_COLORSPACE_REC709;
  node_.quantization = V4L2_QUANTIZATION_FULL_RANGE;
  const Bytes picture = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  node_.pictures = {{picture}};
  const auto camera = open();
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->info().color, (device::ColorEncoding{.matrix = device::YuvMatrix::kBt709,
                                                         .range = device::SampleRange::kFull,
                                                         .transfer = device::Transfer::kBt709}));
  const auto got = take(*camera, 1);
  EXPECT_EQ(got[0].bytes, picture);
  EXPECT_EQ(got[0].flags, device::kFrameOk);
}

// NV12M: luma and chroma in buffers of their own, and a header before each.
/// All drivers on DriverThread end so.
TEST_F(V4l2Camera, WhatItsThreadThrowsIsLoggedAndTheCameraStops) {
  node_.code = V4L2_PIX_FMT_YUYV;
  node_.size = {4, 2};
  node_.planes = {{8, 16}};
  const auto camera = open();
  ASSERT_TRUE(camera);
  {
    const ThrowIn thrown("driver");
    ASSERT_TRUE(camera->start([](const device::FramePtr&) {}));
    EXPECT_TRUE(comes_true([] {
      return logged("driver: no memory is left: stop other programs: no more frames come");
    }));
  }
  camera->stop();
  node_.pictures = {{Bytes(16, 1)}};
  EXPECT_EQ(take(*camera, 1)[0].bytes, Bytes(16, 1)) << "it can be started again";
}

TEST_F(V4l2Camera, PlanesOfAMultiPlanarNodeBecomeOnePicture) {
  node_.multi_planar = true;
  node_.code = V4L2_PIX_FMT_NV12M;
  node_.size = {4, 2};
  node_.planes = {{6, 12, 64}, {4, 4, 32}};
  node_.transfer = V4L2_XFER_FUNC_SRGB;
  node_.ycbcr = V4L2_YCBCR_ENC_709;
  node_.pictures = {{{1, 2, 3, 4, 0, 0, 5, 6, 7, 8, 0, 0}, {9, 10, 11, 12}},
                    {{1, 2, 3, 4, 0, 0, 5, 6, 7, 8, 0, 0}, {9, 10, 11}}};
  const auto camera = open();
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->info().format, device::PixelFormat::kNv12);
  EXPECT_EQ(camera->info().color.matrix, device::YuvMatrix::kBt709);
  const auto got = take(*camera, 2);
  ASSERT_EQ(got[0].bytes.size(), 18U);
  EXPECT_EQ(got[0].stride_bytes, 6U);
  EXPECT_EQ(Bytes(got[0].bytes.begin(), got[0].bytes.begin() + 16),
            (Bytes{1, 2, 3, 4, 0, 0, 5, 6, 7, 8, 0, 0, 9, 10, 11, 12}));
  EXPECT_EQ(got[0].flags, device::kFrameOk);
  EXPECT_NE(got[1].flags & device::kFrameIncomplete, 0U) << "chroma is short";
}

// A sensor's raw picture: MIPI RAW10, linear, one plane of a multi-planar node.
TEST_F(V4l2Camera, PackedRawOfASensorIsUnpacked) {
  node_.multi_planar = true;
  node_.code = V4L2_PIX_FMT_SRGGB10P;
  node_.size = {4, 2};
  node_.planes = {{8, 16}};
  node_.colorspace = V4L2_COLORSPACE_RAW;
  node_.pictures = {{{0xFF, 0x00, 0x80, 0x00, 0b01'00'00'11, 9, 9, 9,  //
                      0x00, 0x00, 0x00, 0xFF, 0b11'00'00'00, 9, 9, 9}}};
  const auto camera = open();
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->info().format, device::PixelFormat::kBayerRggb16);
  EXPECT_EQ(camera->info().sample_bits, 10);
  EXPECT_EQ(camera->info().color.transfer, device::Transfer::kLinear);
  const auto got = take(*camera, 1);
  // 1023, 0, 512, 1 / 0, 0, 0, 1023, of full scale 65535.
  EXPECT_EQ(got[0].bytes, (Bytes{0xFF, 0xFF, 0, 0, 0x20, 0x80, 0x40, 0,  //
                                 0, 0, 0, 0, 0, 0, 0xFF, 0xFF}));
  EXPECT_EQ(got[0].flags, device::kFrameOk);
}

TEST_F(V4l2Camera, ANodeThatDoesNotCaptureIsRefused) {
  node_.capabilities = V4L2_CAP_STREAMING | V4L2_CAP_META_CAPTURE;
  const auto camera = device::V4l2Camera::open(node_.path(), {}, clock_);
  ASSERT_FALSE(camera);
  EXPECT_NE(to_line(camera.error()).find("does not stream pictures"), std::string::npos);
}

TEST_F(V4l2Camera, MorePlanesThanTheFormatHasAreRefused) {
  node_.multi_planar = true;
  node_.code = V4L2_PIX_FMT_YUYV;
  node_.size = {4, 2};
  node_.planes = {{8, 16}, {8, 16}, {8, 16}};
  EXPECT_FALSE(device::V4l2Camera::open(node_.path(), {}, clock_));
}

TEST_F(V4l2Camera, TheFactoryCalibrationOfARealSenseComesThroughItsExtensionUnit) {
  node_.extension_answer = realsense_answer(3, {421.5F, 421.5F, 423.25F, 241.75F});
  const auto k = device::realsense_intrinsics(node_.path(), {848, 480});
  ASSERT_TRUE(k) << to_line(k.error());
  EXPECT_EQ(k->focal_px, 421.5);
  ASSERT_EQ(node_.extension_request.size(), 1024U);
  EXPECT_EQ(node_.extension_request[4], 0x15);
  node_.extension_answer.clear();
  const auto none = device::realsense_intrinsics(node_.path(), {848, 480});
  ASSERT_FALSE(none);
  EXPECT_NE(to_line(none.error()).find("asking for the factory calibration"), std::string::npos);
}

TEST_F(V4l2Camera, UnpluggedAndBackItDeliversAgain) {
  node_.code = V4L2_PIX_FMT_GREY, node_.size = {4, 2}, node_.planes = {{4, 8}};
  for (std::uint8_t i = 0; i < 5; ++i) node_.pictures.push_back({Bytes(8, i)});
  node_.unplug_after = 3, node_.absent_for = 2;
  const auto camera = open();
  ASSERT_TRUE(camera);
  const auto got = take(*camera, 5);
  ASSERT_EQ(got.size(), 5U);
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].bytes, Bytes(8, static_cast<std::uint8_t>(i)));
    EXPECT_EQ(got[i].flags, i == 3 ? device::kFrameRestarted : 0U) << i;
  }
  const device::StreamHealth health = camera->health();
  EXPECT_EQ(health.returns, 1U);
  EXPECT_EQ(health.lost, 0U) << "the counter began anew";
  EXPECT_EQ(health.frames, 5U);
}

/// Lends its buffers.
class V4l2Lending : public V4l2Camera {
 protected:
  /// Grey pictures of 4 x 2, whose bytes are the number of the picture.
  void start(std::size_t pictures) {
    node_.code = V4L2_PIX_FMT_GREY, node_.size = {4, 2}, node_.planes = {{4, 8}};
    for (std::size_t i = 0; i < pictures; ++i)
      node_.pictures.push_back({Bytes(8, static_cast<std::uint8_t>(i))});
    auto camera = device::V4l2Camera::open(node_.path(), {.lends = true}, clock_);
    ASSERT_TRUE(camera) << to_line(camera.error());
    camera_ = *std::move(camera);
    ASSERT_TRUE(camera_->start([this](const device::FramePtr& frame) {
      const std::lock_guard lock(mutex_);
      frames_.push_back(frame);
    }));
    ASSERT_TRUE(comes_true([&] {
      const std::lock_guard lock(mutex_);
      return frames_.size() == pictures;
    }));
  }
  static bool is_open(int fd) { return ::fcntl(fd, F_GETFD) >= 0; }

  std::unique_ptr<device::V4l2Camera> camera_;
  std::mutex mutex_;
  std::vector<device::FramePtr> frames_;
};

TEST_F(V4l2Lending, AFrameIsTheDriversBufferUntilItIsDropped) {
  node_.exports = true, node_.most_buffers = 12;
  start(2);
  for (std::uint8_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(is_open(frames_[i]->memory.fd));
    EXPECT_EQ(frames_[i]->memory.index, i);
    EXPECT_EQ(Bytes(frames_[i]->bytes.begin(), frames_[i]->bytes.end()), Bytes(8, i));
  }
  EXPECT_EQ(frames_[0]->memory.set, frames_[1]->memory.set);
  EXPECT_EQ(node_.queued(), 10U);
  frames_.pop_back();
  EXPECT_TRUE(comes_true([&] { return node_.queued() == 11; }));
}

TEST_F(V4l2Lending, ThreeBuffersStayWithTheDriverAndFurtherFramesAreCopied) {
  node_.exports = true, node_.most_buffers = 5;
  start(4);
  for (std::uint8_t i = 0; i < 4; ++i) {
    EXPECT_EQ(static_cast<bool>(frames_[i]->memory), i < 2) << int{i};
    EXPECT_EQ(Bytes(frames_[i]->bytes.begin(), frames_[i]->bytes.end()), Bytes(8, i));
  }
  EXPECT_EQ(node_.queued(), 3U);
}

TEST_F(V4l2Lending, ADriverThatExportsNothingHasItsFramesCopied) {
  start(3);
  for (const auto& frame : frames_) EXPECT_FALSE(frame->memory);
  EXPECT_EQ(node_.queued(), 4U);
}

TEST_F(V4l2Lending, AFrameOutlivesItsCameraAndClosesTheDescriptors) {
  node_.exports = true, node_.most_buffers = 12;
  start(3);
  const int fd = frames_[1]->memory.fd;
  camera_->stop();
  camera_.reset();
  EXPECT_TRUE(is_open(fd));
  EXPECT_EQ(Bytes(frames_[1]->bytes.begin(), frames_[1]->bytes.end()), Bytes(8, 1));
  frames_.clear();
  EXPECT_FALSE(is_open(fd));
}

TEST_F(V4l2Lending, ACameraThatCameBackHasAnotherSetOfBuffers) {
  node_.exports = true, node_.most_buffers = 12;
  node_.unplug_after = 1, node_.absent_for = 2;
  start(3);
  EXPECT_NE(frames_[0]->memory.set, frames_[1]->memory.set);
  EXPECT_EQ(frames_[1]->memory.set, frames_[2]->memory.set);
  EXPECT_EQ(frames_[1]->bytes[0], 1);
}

TEST_F(V4l2Camera, FramesAreCopiesWhereNobodyAskedForMore) {
  node_.exports = true;
  node_.code = V4L2_PIX_FMT_GREY, node_.size = {4, 2}, node_.planes = {{4, 8}};
  node_.pictures = {{Bytes(8, 3)}};
  const auto camera = open();
  ASSERT_TRUE(camera);
  EXPECT_EQ(take(*camera, 1)[0].memory_fd, -1);
}

}  // namespace
}  // namespace mixrig::test
