// SPDX-License-Identifier: Apache-2.0
// The meaning of samples and steps, stated by a camera and rig.toml, is kept from the frames of a
// rig into a take and out of it.
#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "hal/fake/fake_camera.h"
#include "host/capture/live/session/live_capture.h"
#include "host/capture/take/take_source.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::live {
namespace {

constexpr Size kSize{4, 1};
// Steps 0, 4000, 40000 and 65535.
constexpr std::array<std::uint8_t, 8> kSteps = {0, 0, 0xA0, 0x0F, 0x40, 0x9C, 0xFF, 0xFF};
constexpr std::array<std::uint8_t, 12> kPlate = {46, 46, 46, 0, 0, 0, 255, 255, 255, 46, 46, 46};

class DepthSteps : public ::testing::Test {
 protected:
  DepthSteps() {
    config_.file = "rig.toml";
    config_.cameras.emplace_back();
    config_.depth.emplace();
    devices_.cameras.push_back(std::make_unique<fake::FakeCamera>(
        clock_, device::CameraInfo{.uri = "fake:color",
                                   .size = kSize,
                                   .format = device::PixelFormat::kRgb8,
                                   .rate_hz = 25}));
  }
  void connect(const device::DepthInfo& told) {
    devices_.depth = device::as_depth_camera(
        std::make_unique<fake::FakeCamera>(
            clock_, device::CameraInfo{.uri = "fake:depth",
                                       .model = "Model 7",
                                       .size = kSize,
                                       .format = device::PixelFormat::kDepth16}),
        told);
  }
  static device::FramePtr frame(device::PixelFormat format, std::span<const std::uint8_t> bytes) {
    device::Frame frame{.format = format, .size = kSize, .bytes = bytes};
    frame.stride_bytes = device::row_bytes(format, kSize.width);
    return std::make_shared<device::Frame>(frame);
  }
  capture::Capture decoded() {
    LiveSet set;
    set.frames.frames[0].frame = frame(device::PixelFormat::kRgb8, kPlate);
    set.frames.frames[1].frame = frame(device::PixelFormat::kDepth16, kSteps);
    capture::Capture capture;
    const auto done = SetDecoder(config_, devices_).decode(set, capture);
    EXPECT_TRUE(done) << to_line(done.error());
    return capture;
  }
  void expect_depth(const Image<float>& depth_m, double unit_m, double offset_m) {
    EXPECT_FLOAT_EQ(depth_m.at(1, 0), static_cast<float>(4000 * unit_m + offset_m));
    EXPECT_FLOAT_EQ(depth_m.at(2, 0), static_cast<float>(40000 * unit_m + offset_m));
    EXPECT_EQ(depth_m.at(0, 0), 0.0F);
    EXPECT_EQ(depth_m.at(3, 0), 0.0F);
  }

  ManualClock clock_;
  RigConfig config_;
  Devices devices_;
};

TEST_F(DepthSteps, ACameraThatDoesNotTellItsUnitIsRefusedUntilRigTomlDoes) {
  connect({.unit_known = false});
  const auto refused = check_unit(config_, *devices_.depth);
  ASSERT_FALSE(refused);
  EXPECT_NE(
      to_line(refused.error())
          .find(
              "fake:depth: \"Model 7\" does not report the length of a depth step: give [depth] a "
              "unit_m in rig.toml"),
      std::string::npos)
      << to_line(refused.error());
  config_.depth_steps.unit_m = 0.00025;
  EXPECT_TRUE(check_unit(config_, *devices_.depth));
}

TEST_F(DepthSteps, WhatRigTomlSaysIsInTheDepthInTheTakeAndInThePlayedTake) {
  connect({.unknown_steps = {0}});
  config_.depth_steps.unit_m = 0.00025;
  config_.depth_steps.offset_m = -0.0125;
  config_.depth_steps.kind = device::DepthMeaning::kDistance;
  config_.depth_steps.unknown = {0, 65535};
  config_.depth_steps.noise = geometry::DepthNoise{0.001, 0.002, 0.003};
  const capture::Capture capture = decoded();
  expect_depth(capture.depth_m, 0.00025, -0.0125);
  const auto info = take_info(config_, devices_);
  ASSERT_TRUE(info) << to_line(info.error());

  test::TemporaryFolder folder;
  auto writer = take::TakeWriter::create(folder / "take", *info, take::StreamFormat::kPng);
  ASSERT_TRUE(writer) << to_line(writer.error());
  ASSERT_TRUE(writer->write(capture));
  ASSERT_TRUE(writer->finish());
  const auto source = take::open_take_source(folder / "take");
  ASSERT_TRUE(source) << to_line(source.error());
  capture::Capture read;
  ASSERT_TRUE(*(*source)->read(1, read));
  expect_depth(read.depth_m, 0.00025, -0.0125);
  EXPECT_EQ((*source)->info().depth_kind, capture::DepthKind::kDistance);
  EXPECT_EQ((*source)->info().noise.quadratic_per_m, 0.003);
}

TEST_F(DepthSteps, WhatTheCameraTellsCountsWhereRigTomlSaysNothing) {
  connect({.metres_per_step = 0.00025, .offset_m = 0.5, .unknown_steps = {65535, 0}});
  expect_depth(decoded().depth_m, 0.00025, 0.5);
}

TEST_F(DepthSteps, ALinearCamerasGreyCardIsThatOfAWebcam) {
  connect({});
  config_.cameras[0].color.transfer = device::Transfer::kLinear;
  const capture::Capture capture = decoded();
  // 46/255 = 18 % of light is 118 in sRGB (IEC 61966-2-1).
  EXPECT_EQ(capture.plate.at(0, 0), (Rgb8{118, 118, 118}));
  EXPECT_EQ(capture.plate.at(1, 0), (Rgb8{0, 0, 0}));
  EXPECT_EQ(capture.plate.at(2, 0), (Rgb8{255, 255, 255}));
}

}  // namespace
}  // namespace mixrig::live
