// SPDX-License-Identifier: Apache-2.0
#include "hal/device/depth_camera.h"

#include <array>

#include "hal/fake/fake_camera.h"
#include "tests/unit/hal_device/depth_camera_contract.h"

namespace mixrig::device {
namespace {

using test::DepthCameraContract;

// Steps 0, 1000, 4660 (0x1234) and 65535, rows padded to 6 bytes.
constexpr std::array<std::uint8_t, 10> kBytes = {0,    0,    0xE8, 0x03, 0xAA,
                                                 0xAA, 0x34, 0x12, 0xFF, 0xFF};

Frame frame() {
  return {.format = PixelFormat::kDepth16, .size = {2, 2}, .stride_bytes = 6, .bytes = kBytes};
}

TEST(DepthMetres, StepsAreScaledAndUnknownStaysUnknown) {
  Image<float> out;
  ASSERT_TRUE(to_metres(frame(), {.metres_per_step = 0.001, .unknown_steps = {0}}, out));
  EXPECT_EQ(out.at(0, 0), 0.0F);
  EXPECT_FLOAT_EQ(out.at(1, 0), 1.0F);
  EXPECT_FLOAT_EQ(out.at(0, 1), 4.66F);
  EXPECT_FLOAT_EQ(out.at(1, 1), 65.535F);
}

TEST(DepthMetres, OffsetAndOtherUnknownValue) {
  Image<float> out;
  ASSERT_TRUE(to_metres(
      frame(), {.metres_per_step = 0.00025, .offset_m = 0.5, .unknown_steps = {65535}}, out));
  EXPECT_FLOAT_EQ(out.at(0, 0), 0.5F);
  EXPECT_FLOAT_EQ(out.at(1, 0), 0.75F);
  EXPECT_EQ(out.at(1, 1), 0.0F);
}

TEST(DepthMetres, EveryUnknownStepIsUnknown) {
  Image<float> out;
  ASSERT_TRUE(to_metres(frame(), {.unknown_steps = {65535, 1000}}, out));
  EXPECT_EQ(out.at(0, 0), 0.0F) << "step 0 is no depth either";
  EXPECT_EQ(out.at(1, 0), 0.0F);
  EXPECT_FLOAT_EQ(out.at(0, 1), 4.66F);
  EXPECT_EQ(out.at(1, 1), 0.0F);
}

TEST(DepthMetres, DepthOfLessConfidenceIsUnknown) {
  // Packed: 0, 500, 501, 65535.
  constexpr std::array<std::uint8_t, 8> kJudged = {0, 0, 0xF4, 1, 0xF5, 1, 0xFF, 0xFF};
  Image<float> out;
  Frame judged = frame();
  judged.amplitude = kJudged;
  ASSERT_TRUE(to_metres(judged, {.least_confidence = 501}, out));
  EXPECT_EQ(out.at(1, 0), 0.0F);
  EXPECT_FLOAT_EQ(out.at(0, 1), 4.66F);
  EXPECT_FLOAT_EQ(out.at(1, 1), 65.535F);
  constexpr std::array<std::uint8_t, 8> kSure = {0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0xFF, 0xFF};
  judged.confidence = kSure;
  ASSERT_TRUE(to_metres(judged, {.least_confidence = 501}, out));
  EXPECT_FLOAT_EQ(out.at(1, 0), 1.0F) << "a confidence of its own goes before the amplitude";
  EXPECT_EQ(out.at(0, 1), 0.0F);
  judged.confidence = std::span(kSure).first(6);
  ASSERT_TRUE(to_metres(judged, {.least_confidence = 501}, out));
  EXPECT_FLOAT_EQ(out.at(0, 1), 4.66F) << "too short to judge by";
}

TEST(DepthMetres, NegativeDepthIsUnknown) {
  Image<float> out;
  ASSERT_TRUE(
      to_metres(frame(), {.metres_per_step = 0.001, .offset_m = -2.0, .unknown_steps = {0}}, out));
  EXPECT_EQ(out.at(1, 0), 0.0F);
}

TEST(DepthMetres, ShortFramesAndOtherFormatsAreRefused) {
  Image<float> out;
  Frame bad = frame();
  bad.bytes = bad.bytes.first(9);
  EXPECT_FALSE(to_metres(bad, {}, out));
  bad = frame();
  bad.format = PixelFormat::kRgb8;
  EXPECT_FALSE(to_metres(bad, {}, out));
  bad = frame();
  bad.stride_bytes = 3;
  EXPECT_FALSE(to_metres(bad, {}, out));
}

TEST(PixelFormats, SizesOfAPicture) {
  EXPECT_EQ(image_bytes(PixelFormat::kYuyv, {640, 480}, row_bytes(PixelFormat::kYuyv, 640)),
            614400U);
  EXPECT_EQ(image_bytes(PixelFormat::kNv12, {640, 480}, row_bytes(PixelFormat::kNv12, 640)),
            460800U);
  EXPECT_EQ(image_bytes(PixelFormat::kRgb8, {3, 2}, row_bytes(PixelFormat::kRgb8, 3)), 18U);
  EXPECT_EQ(image_bytes(PixelFormat::kMjpeg, {640, 480}, 0), 0U);
}

/// A camera of 16-bit steps, wrapped as a depth camera.
test::DepthCameraUnderTest make_wrapped() {
  auto clock = std::make_shared<ManualClock>();
  auto camera = std::make_unique<fake::FakeCamera>(
      *clock, CameraInfo{.uri = "fake:depth", .size = {8, 4}, .format = PixelFormat::kDepth16});
  auto* raw = camera.get();
  return {as_depth_camera(std::move(camera), {}),
          [clock, raw](int count) {
            for (int i = 0; i < count; ++i) raw->emit();
          },
          clock};
}

INSTANTIATE_TEST_SUITE_P(Wrapped, DepthCameraContract,
                         ::testing::Values(test::DepthCameraMaker{"wrapped", make_wrapped}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::device
