// SPDX-License-Identifier: Apache-2.0
// Plates that stay in their camera's memory: which forms a capture has, and when the buffer goes
// back.
#include <gtest/gtest.h>

#include "hal/fake/fake_camera.h"
#include "host/capture/live/session/live_capture.h"
#include "tests/support/count_allocations.h"

namespace mixrig::live {
namespace {

constexpr Size kPlate_px{4, 2};

class SharedPlate : public ::testing::Test {
 protected:
  void SetUp() override {
    config_.cameras.emplace_back();
    config_.depth.emplace();
    devices_.cameras.push_back(std::make_unique<fake::FakeCamera>(
        clock_,
        device::CameraInfo{
            .uri = "fake:color", .size = kPlate_px, .format = device::PixelFormat::kGray8}));
    devices_.depth = device::as_depth_camera(
        std::make_unique<fake::FakeCamera>(
            clock_,
            device::CameraInfo{
                .uri = "fake:depth", .size = kPlate_px, .format = device::PixelFormat::kDepth16}),
        {});
    plate_ =
        std::make_shared<device::Frame>(device::Frame{.format = device::PixelFormat::kGray8,
                                                      .size = kPlate_px,
                                                      .stride_bytes = 4,
                                                      .bytes = bytes_,
                                                      .memory = {.fd = 5, .set = 1, .index = 2}});
    set_.frames.frames[0].frame = plate_;
    set_.frames.frames[1].frame =
        std::make_shared<device::Frame>(device::Frame{.format = device::PixelFormat::kDepth16,
                                                      .size = kPlate_px,
                                                      .stride_bytes = 8,
                                                      .bytes = steps_});
    decoder_.emplace(config_, devices_);
  }
  void decode(capture::PlateForms forms) {
    decoder_->share_plates(forms);
    const auto done = decoder_->decode(set_, capture_);
    ASSERT_TRUE(done) << to_line(done.error());
  }

  std::array<std::uint8_t, 8> bytes_{1, 2, 3, 4, 5, 6, 7, 8};
  std::array<std::uint8_t, 16> steps_{};
  ManualClock clock_;
  RigConfig config_;
  Devices devices_;
  std::shared_ptr<device::Frame> plate_;
  LiveSet set_;
  std::optional<SetDecoder> decoder_;
  capture::Capture capture_;
};

TEST_F(SharedPlate, IsDecodedAndItsBufferFreeUnlessSomebodyReadsItInPlace) {
  decode({});
  EXPECT_EQ(capture_.picture, nullptr);
  EXPECT_EQ(capture_.plate.at(3, 1), (Rgb8{8, 8, 8}));
  EXPECT_EQ(plate_.use_count(), 2) << "the test and its set";
}

TEST_F(SharedPlate, StaysInItsMemoryWhereNobodyLooks) {
  decode({.shared = true, .decoded = false});
  EXPECT_TRUE(capture_.plate.empty());
  ASSERT_NE(capture_.picture, nullptr);
  EXPECT_EQ(capture_.picture->raw().memory.index, 2U);
  EXPECT_EQ(plate_.use_count(), 3);
  EXPECT_EQ(capture::plate_of(capture_).at(2, 0), (Rgb8{3, 3, 3}));
  decode({});
  EXPECT_EQ(capture_.picture, nullptr);
  EXPECT_EQ(capture_.plate.at(2, 0), (Rgb8{3, 3, 3}));
  EXPECT_EQ(plate_.use_count(), 2);
}

TEST_F(SharedPlate, ComesInBothFormsWhereTheHostLooksToo) {
  decode({.shared = true, .decoded = true});
  EXPECT_NE(capture_.picture, nullptr);
  EXPECT_EQ(capture_.plate.at(0, 1), (Rgb8{5, 5, 5}));
}

TEST_F(SharedPlate, IsDecodedWhereItsDriverCopied) {
  plate_->memory = {};
  decode({.shared = true, .decoded = false});
  EXPECT_EQ(capture_.picture, nullptr);
  EXPECT_EQ(capture_.plate.at(3, 1), (Rgb8{8, 8, 8}));
}

TEST_F(SharedPlate, AllocatesNothingFrameByFrame) {
  for (int i = 0; i < 3; ++i) decode({.shared = true, .decoded = false});
  const long before = test::allocations;
  for (int i = 0; i < 20; ++i) (void)decoder_->decode(set_, capture_);
  EXPECT_EQ(test::allocations - before, 0);
}

}  // namespace
}  // namespace mixrig::live
