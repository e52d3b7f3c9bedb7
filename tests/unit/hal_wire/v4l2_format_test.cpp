// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/v4l2_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

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

Result<V4l2Layout> checked(std::uint32_t code, std::uint32_t width, std::uint32_t height,
                           std::uint32_t stride, std::uint32_t bytes) {
  const V4l2Plane plane{stride, bytes};
  return checked_layout(code, width, height, {&plane, 1});
}

TEST(CheckedLayout, AcceptsLayoutsThatHoldThePicture) {
  const auto layout = checked(kYuyv, 640, 480, 1280, 614400);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->stride_bytes, 1280U);
  EXPECT_EQ(layout->picture_bytes, 614400U);
  EXPECT_EQ(checked(kYuyv, 640, 480, 0, 614400)->stride_bytes, 1280U) << "0: packed";
  EXPECT_EQ(checked(kYuyv, 640, 480, 1344, 1344 * 480)->stride_bytes, 1344U);
  EXPECT_EQ(checked(kMjpg, 640, 480, 0, 100000)->picture_bytes, 100000U);
  EXPECT_EQ(checked(kZ16, 320, 240, 640, 153600)->format, PixelFormat::kDepth16);
}

TEST(CheckedLayout, RefusesLayoutsThatWouldBeReadBeyondTheirEnd) {
  EXPECT_FALSE(checked(kYuyv, 640, 480, 1280, 614399));
  EXPECT_FALSE(checked(kYuyv, 640, 480, 1279, 614400));
  EXPECT_FALSE(checked(kYuyv, 0, 480, 1280, 614400));
  EXPECT_FALSE(checked(kYuyv, 0xFFFFFFFF, 480, 1280, 614400));
  EXPECT_FALSE(checked(kYuyv, 640, 480, 0x7FFFFFFF, 614400));
  EXPECT_FALSE(checked(kH264, 640, 480, 1280, 614400));
}

constexpr std::uint32_t kNv12m = fourcc('N', 'M', '1', '2'), kRaw10 = fourcc('p', 'R', 'A', 'A');

TEST(CheckedLayout, PlanesAreThoseOfTheFormat) {
  const V4l2Plane two[] = {{640, 640 * 480}, {640, 640 * 240}};
  const auto layout = checked_layout(kNv12m, 640, 480, two);
  ASSERT_TRUE(layout) << to_line(layout.error());
  EXPECT_EQ(layout->format, PixelFormat::kNv12);
  EXPECT_EQ(layout->picture_bytes, 640U * 720);
  EXPECT_FALSE(checked_layout(kNv12m, 640, 480, std::span(two).first(1)));
  EXPECT_FALSE(checked_layout(kYuyv, 640, 480, two));
  const V4l2Plane short_chroma[] = {{640, 640 * 480}, {640, 640 * 240 - 1}};
  EXPECT_FALSE(checked_layout(kNv12m, 640, 480, short_chroma));
}

TEST(CheckedLayout, PackedSamplesAreUnpackedInFrames) {
  const auto layout = checked(kRaw10, 640, 480, 800, 800 * 480);
  ASSERT_TRUE(layout) << to_line(layout.error());
  EXPECT_EQ(layout->format, PixelFormat::kBayerRggb16);
  EXPECT_EQ(layout->sample_bits, 10);
  EXPECT_EQ(layout->stride_bytes, 1280U);
  EXPECT_EQ(layout->picture_bytes, 1280U * 480);
  EXPECT_EQ(layout->plane_bytes[0], 800U * 480);
  EXPECT_FALSE(checked(kRaw10, 640, 480, 799, 800 * 480));
}

// The kernel's own fourcc of each layout.
TEST(CheckedLayout, EveryGreyAndBayerFormatIsReadAsItsKernelNameSays) {
  struct Raw {
    std::uint32_t code;
    PixelFormat format;
    int bits;
    SamplePacking packing;
  };
  using enum SamplePacking;
  for (const Raw& c : {Raw{V4L2_PIX_FMT_Y10, PixelFormat::kGray16, 10, kWords},
                       Raw{V4L2_PIX_FMT_Y12, PixelFormat::kGray16, 12, kWords},
                       Raw{V4L2_PIX_FMT_Y16, PixelFormat::kGray16, 16, kNone},
                       Raw{V4L2_PIX_FMT_Y10P, PixelFormat::kGray16, 10, kMipi},
                       Raw{V4L2_PIX_FMT_Y10BPACK, PixelFormat::kGray16, 10, kBig},
                       Raw{V4L2_PIX_FMT_SRGGB10, PixelFormat::kBayerRggb16, 10, kWords},
                       Raw{V4L2_PIX_FMT_SGRBG10, PixelFormat::kBayerGrbg16, 10, kWords},
                       Raw{V4L2_PIX_FMT_SGBRG10, PixelFormat::kBayerGbrg16, 10, kWords},
                       Raw{V4L2_PIX_FMT_SBGGR10, PixelFormat::kBayerBggr16, 10, kWords},
                       Raw{V4L2_PIX_FMT_SRGGB10P, PixelFormat::kBayerRggb16, 10, kMipi},
                       Raw{V4L2_PIX_FMT_SGRBG10P, PixelFormat::kBayerGrbg16, 10, kMipi},
                       Raw{V4L2_PIX_FMT_SGBRG10P, PixelFormat::kBayerGbrg16, 10, kMipi},
                       Raw{V4L2_PIX_FMT_SBGGR10P, PixelFormat::kBayerBggr16, 10, kMipi},
                       Raw{V4L2_PIX_FMT_SRGGB12, PixelFormat::kBayerRggb16, 12, kWords},
                       Raw{V4L2_PIX_FMT_SGRBG12, PixelFormat::kBayerGrbg16, 12, kWords},
                       Raw{V4L2_PIX_FMT_SGBRG12, PixelFormat::kBayerGbrg16, 12, kWords},
                       Raw{V4L2_PIX_FMT_SBGGR12, PixelFormat::kBayerBggr16, 12, kWords},
                       Raw{V4L2_PIX_FMT_Y14, PixelFormat::kGray16, 14, kWords},
                       Raw{V4L2_PIX_FMT_SRGGB14, PixelFormat::kBayerRggb16, 14, kWords},
                       Raw{V4L2_PIX_FMT_SGRBG14, PixelFormat::kBayerGrbg16, 14, kWords},
                       Raw{V4L2_PIX_FMT_SGBRG14, PixelFormat::kBayerGbrg16, 14, kWords},
                       Raw{V4L2_PIX_FMT_SBGGR14, PixelFormat::kBayerBggr16, 14, kWords},
                       Raw{V4L2_PIX_FMT_SRGGB12P, PixelFormat::kBayerRggb16, 12, kMipi},
                       Raw{V4L2_PIX_FMT_SGRBG12P, PixelFormat::kBayerGrbg16, 12, kMipi},
                       Raw{V4L2_PIX_FMT_SGBRG12P, PixelFormat::kBayerGbrg16, 12, kMipi},
                       Raw{V4L2_PIX_FMT_SBGGR12P, PixelFormat::kBayerBggr16, 12, kMipi},
                       Raw{V4L2_PIX_FMT_SRGGB16, PixelFormat::kBayerRggb16, 16, kNone},
                       Raw{V4L2_PIX_FMT_SGRBG16, PixelFormat::kBayerGrbg16, 16, kNone},
                       Raw{V4L2_PIX_FMT_SGBRG16, PixelFormat::kBayerGbrg16, 16, kNone},
                       Raw{V4L2_PIX_FMT_SBGGR16, PixelFormat::kBayerBggr16, 16, kNone}}) {
    const auto layout = checked(c.code, 16, 4, 0, 1000);
    ASSERT_TRUE(layout) << std::hex << c.code;
    EXPECT_EQ(layout->format, c.format) << std::hex << c.code;
    EXPECT_EQ(layout->sample_bits, c.bits) << std::hex << c.code;
    EXPECT_EQ(layout->packed.packing, c.packing) << std::hex << c.code;
  }
}

TEST(CopyPicture, TwoPlanesOfDifferentStridesBecomeOne) {
  const V4l2Plane planes[] = {{4, 8}, {6, 6}};
  const auto layout = checked_layout(kNv12m, 4, 2, planes);
  ASSERT_TRUE(layout);
  const std::vector<std::uint8_t> luma = {1, 2, 3, 4, 5, 6, 7, 8}, chroma = {9, 10, 11, 12, 0, 0};
  std::vector<std::uint8_t> out(layout->picture_bytes);
  EXPECT_EQ(copy_v4l2_picture(*layout, {luma, chroma}, out), 12U);
  EXPECT_EQ(out, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
  EXPECT_LT(copy_v4l2_picture(*layout, {luma, std::span(chroma).first(3)}, out), 12U);
  EXPECT_EQ(payload_flags(*layout, {luma, chroma}, false), kFrameOk);
  EXPECT_EQ(payload_flags(*layout, {luma, std::span(chroma).first(3)}, false), kFrameIncomplete);
}

TEST(PayloadFlags, ShortOrFaultyPicturesAreIncomplete) {
  const std::vector<std::uint8_t> whole(614400);
  const auto first = [&](std::size_t count) { return V4l2Bytes{std::span(whole).first(count)}; };
  const V4l2Layout raw = *checked(kYuyv, 640, 480, 1280, 614400);
  EXPECT_EQ(payload_flags(raw, first(614400), false), kFrameOk);
  EXPECT_EQ(payload_flags(raw, first(614399), false), kFrameIncomplete);
  EXPECT_EQ(payload_flags(raw, first(614400), true), kFrameIncomplete);
  const V4l2Layout jpeg = *checked(kMjpg, 640, 480, 0, 100000);
  EXPECT_EQ(payload_flags(jpeg, first(5000), false), kFrameOk);
  EXPECT_EQ(payload_flags(jpeg, first(0), false), kFrameIncomplete);
}

// The kernel's rules for what a driver leaves open, by its own macros.
TEST(Colors, DefaultsFollowTheKernel) {
  EXPECT_EQ(encoding_of({}), ColorEncoding());
  for (std::uint32_t space = V4L2_COLORSPACE_SMPTE170M; space <= V4L2_COLORSPACE_DCI_P3; ++space) {
    const ColorEncoding left_open = encoding_of({.colorspace = space});
    const ColorEncoding said =
        encoding_of({.colorspace = space,
                     .ycbcr = static_cast<std::uint32_t>(V4L2_MAP_YCBCR_ENC_DEFAULT(space)),
                     .transfer = static_cast<std::uint32_t>(V4L2_MAP_XFER_FUNC_DEFAULT(space))});
    EXPECT_EQ(left_open, said) << space;
    const bool full =
        V4L2_MAP_QUANTIZATION_DEFAULT(false, space, 0) == V4L2_QUANTIZATION_FULL_RANGE;
    EXPECT_EQ(left_open.range == SampleRange::kFull, full) << space;
  }
}

TEST(Colors, WhatTheDriverSaysIsHonoured) {
  const auto transfer = [](std::uint32_t number) {
    return encoding_of({.colorspace = V4L2_COLORSPACE_SRGB, .transfer = number}).transfer;
  };
  EXPECT_EQ(transfer(V4L2_XFER_FUNC_SRGB), Transfer::kSrgb);
  EXPECT_EQ(transfer(V4L2_XFER_FUNC_709), Transfer::kBt709);
  EXPECT_EQ(transfer(V4L2_XFER_FUNC_NONE), Transfer::kLinear);
  EXPECT_EQ(transfer(V4L2_XFER_FUNC_OPRGB), Transfer::kGamma);
  EXPECT_EQ(encoding_of({.colorspace = V4L2_COLORSPACE_RAW}).transfer, Transfer::kLinear);
  EXPECT_EQ(encoding_of({.ycbcr = V4L2_YCBCR_ENC_709}).matrix, YuvMatrix::kBt709);
  EXPECT_EQ(encoding_of({.ycbcr = V4L2_YCBCR_ENC_601}).matrix, YuvMatrix::kBt601);
  EXPECT_EQ(encoding_of({.ycbcr = V4L2_YCBCR_ENC_BT2020}).matrix, YuvMatrix::kBt2020);
  EXPECT_EQ(encoding_of({.quantization = V4L2_QUANTIZATION_FULL_RANGE}).range, SampleRange::kFull);
  EXPECT_EQ(encoding_of({.quantization = V4L2_QUANTIZATION_LIM_RANGE}).range,
            SampleRange::kLimited);
}

TEST(Z16, UnitsAreThoseThatTheMakerStates) {
  EXPECT_EQ(z16_metres_per_step(0x8086, 0x0B07), 0.001);    // D435
  EXPECT_EQ(z16_metres_per_step(0x8086, 0x0B5B), 0.0001);   // D405
  EXPECT_EQ(z16_metres_per_step(0x8086, 0x0B64), 0.00025);  // L515
  EXPECT_FALSE(z16_metres_per_step(0x8086, 0x1234));
  EXPECT_FALSE(z16_metres_per_step(0, 0));
}

}  // namespace
}  // namespace mixrig::device
