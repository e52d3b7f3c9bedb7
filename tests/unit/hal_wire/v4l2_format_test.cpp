// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/v4l2_format.h"

#include <gtest/gtest.h>

namespace mixrig::device {
namespace {

constexpr std::uint32_t kYuyv = fourcc('Y', 'U', 'Y', 'V'), kMjpg = fourcc('M', 'J', 'P', 'G'),
                        kZ16 = fourcc('Z', '1', '6', ' '), kH264 = fourcc('H', '2', '6', '4');

V4l2Mode mode(std::uint32_t code, Size size, double rate_hz) {
  return {.code = code, .minimum = size, .maximum = size, .max_rate_hz = rate_hz};
}

// A typical webcam: raw only up to VGA at full rate, MJPEG above.
const std::vector<V4l2Mode> kWebcam = {
    mode(kH264, {1920, 1080}, 30), mode(kYuyv, {640, 480}, 30),   mode(kYuyv, {1280, 720}, 10),
    mode(kMjpg, {1280, 720}, 60),  mode(kMjpg, {1920, 1080}, 30), mode(kMjpg, {3840, 2160}, 30)};

struct Case {
  const char* name;
  StreamRequest request;
  std::uint32_t code;  // 0: refused
  Size size;
};

class ChooseMode : public ::testing::TestWithParam<Case> {};

TEST_P(ChooseMode, SelectsTheModeThatFitsTheRequest) {
  const auto choice = choose_mode(kWebcam, GetParam().request);
  if (GetParam().code == 0) {
    ASSERT_FALSE(choice);
    EXPECT_EQ(choice.error().code, ErrorCode::kUnsupported);
    return;
  }
  ASSERT_TRUE(choice) << to_line(choice.error());
  EXPECT_EQ(choice->code, GetParam().code);
  EXPECT_EQ(choice->size, GetParam().size);
}

INSTANTIATE_TEST_SUITE_P(
    Webcam, ChooseMode,
    ::testing::Values(
        Case{"no_request_selects_raw", {}, kYuyv, {1280, 720}},
        Case{"rate_outweighs_raw", {.size = {1280, 720}, .rate_hz = 30}, kMjpg, {1280, 720}},
        Case{"size_alone", {.size = {640, 480}}, kYuyv, {640, 480}},
        Case{"format_alone_limits_the_size", {.format = PixelFormat::kMjpeg}, kMjpg, {1920, 1080}},
        Case{"large_when_requested", {.size = {3840, 2160}}, kMjpg, {3840, 2160}},
        Case{"rate_not_offered", {.size = {1920, 1080}, .rate_hz = 120}, kMjpg, {1920, 1080}},
        Case{"size_not_offered", {.size = {800, 600}}, 0, {}},
        Case{"format_not_offered", {.format = PixelFormat::kNv12}, 0, {}}),
    [](const auto& c) { return c.param.name; });

TEST(ChooseModeRange, SteppedSizesAreMatchedExactlyOrRefused) {
  const std::vector<V4l2Mode> modes = {
      {.code = kYuyv, .minimum = {16, 16}, .maximum = {4096, 2160}, .step = {8, 2}}};
  EXPECT_EQ(choose_mode(modes, {.size = {1280, 1024}})->size, (Size{1280, 1024}));
  EXPECT_FALSE(choose_mode(modes, {.size = {1283, 1024}}));
  EXPECT_EQ(choose_mode(modes, {})->size, (Size{1920, 1200}));
}

TEST(ChooseModeRange, InvalidModesAreSkipped) {
  const std::vector<V4l2Mode> modes = {
      mode(kYuyv, {0, 0}, 30),
      mode(kYuyv, {-5, 7}, 30),
      {.code = kYuyv, .minimum = {640, 480}, .maximum = {320, 240}},
      mode(kYuyv, {1 << 30, 1 << 30}, 30)};
  EXPECT_FALSE(choose_mode(modes, {}));
  EXPECT_FALSE(choose_mode({}, {}));
}

TEST(CheckedLayout, AcceptsLayoutsThatHoldThePicture) {
  const auto layout = checked_layout(kYuyv, 640, 480, 1280, 614400);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->stride_bytes, 1280U);
  EXPECT_EQ(layout->picture_bytes, 614400U);
  EXPECT_EQ(checked_layout(kYuyv, 640, 480, 0, 614400)->stride_bytes, 1280U) << "0: packed";
  EXPECT_EQ(checked_layout(kYuyv, 640, 480, 1344, 1344 * 480)->stride_bytes, 1344U);
  EXPECT_EQ(checked_layout(kMjpg, 640, 480, 0, 100000)->picture_bytes, 100000U);
  EXPECT_EQ(checked_layout(kZ16, 320, 240, 640, 153600)->format, PixelFormat::kDepth16);
}

TEST(CheckedLayout, RefusesLayoutsThatWouldBeReadBeyondTheirEnd) {
  EXPECT_FALSE(checked_layout(kYuyv, 640, 480, 1280, 614399));
  EXPECT_FALSE(checked_layout(kYuyv, 640, 480, 1279, 614400));
  EXPECT_FALSE(checked_layout(kYuyv, 0, 480, 1280, 614400));
  EXPECT_FALSE(checked_layout(kYuyv, 0xFFFFFFFF, 480, 1280, 614400));
  EXPECT_FALSE(checked_layout(kYuyv, 640, 480, 0x7FFFFFFF, 614400));
  EXPECT_FALSE(checked_layout(kH264, 640, 480, 1280, 614400));
}

TEST(PayloadFlags, ShortOrFaultyPicturesAreIncomplete) {
  const V4l2Layout raw = *checked_layout(kYuyv, 640, 480, 1280, 614400);
  EXPECT_EQ(payload_flags(raw, 614400, false), kFrameOk);
  EXPECT_EQ(payload_flags(raw, 614399, false), kFrameIncomplete);
  EXPECT_EQ(payload_flags(raw, 614400, true), kFrameIncomplete);
  const V4l2Layout jpeg = *checked_layout(kMjpg, 640, 480, 0, 100000);
  EXPECT_EQ(payload_flags(jpeg, 5000, false), kFrameOk);
  EXPECT_EQ(payload_flags(jpeg, 0, false), kFrameIncomplete);
}

}  // namespace
}  // namespace mixrig::device
