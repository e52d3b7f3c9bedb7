// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/genicam_buffer.h"

#include <vector>

#include <gtest/gtest.h>

namespace mixrig::device {
namespace {

TEST(GenicamBuffer, DeclaredSizesFollowTheCodesBitsPerPixel) {
  // Bits 16..23 of a PFNC code are the bits per pixel.
  for (const std::uint32_t code :
       {pfnc::kMono8, pfnc::kMono16, pfnc::kRgb8, pfnc::kBgr8, pfnc::kBayerRg8, pfnc::kYuyv,
        pfnc::kMono10, pfnc::kMono12, pfnc::kMono10p, pfnc::kMono12p, pfnc::kBayerRg10p,
        pfnc::kBayerRg12p, pfnc::kCoord3dC16, pfnc::kCoord3dAbc16, pfnc::kCoord3dAbcy16,
        pfnc::kCoord3dC32f, pfnc::kCoord3dAbc32f})
    EXPECT_EQ(declared_bytes(code, {640, 480}), 640U * 480U * (code >> 16 & 0xFF) / 8)
        << std::hex << code;
  EXPECT_EQ(declared_bytes(0x12345678, {640, 480}), 0U);
  EXPECT_EQ(declared_bytes(pfnc::kMono8, {0, 480}), 0U);
  EXPECT_EQ(declared_bytes(pfnc::kMono8, {1 << 30, 1 << 30}), 0U);
}

TEST(GenicamBuffer, AnOversizedPartIsCutToItsGeometry) {
  std::vector<std::uint8_t> data(4 * 3 * 2 + 704, 0xEE), out(4 * 3 * 2);
  for (std::size_t i = 0; i < 24; ++i) data[i] = static_cast<std::uint8_t>(i);
  ASSERT_TRUE(copy_picture(pfnc::kMono16, {4, 3}, data, out));
  EXPECT_EQ(out[23], 23);
}

TEST(GenicamBuffer, AShortPartIsRefusedAndNothingIsRead) {
  const std::vector<std::uint8_t> data(23);
  std::vector<std::uint8_t> out(24, 7);
  EXPECT_FALSE(copy_picture(pfnc::kMono16, {4, 3}, data, out));
  EXPECT_EQ(out[0], 7);
  EXPECT_FALSE(copy_picture(pfnc::kMono8, {4, 3}, {}, out));
}

TEST(GenicamBuffer, ASmallTargetIsRefused) {
  const std::vector<std::uint8_t> data(1000);
  std::vector<std::uint8_t> out(23);
  EXPECT_FALSE(copy_picture(pfnc::kMono16, {4, 3}, data, out));
}

using Bytes = std::vector<std::uint8_t>;

/// The three maps of a depth frame of `size`.
struct Maps {
  explicit Maps(Size size)
      : depth(2 * size.area()), amplitude(depth.size()), confidence(depth.size()) {}
  DepthBuffers buffers() { return {depth, amplitude, confidence}; }
  Bytes depth, amplitude, confidence;
};

TEST(GenicamBuffer, OfPointsOnlyTheDepthIsKept) {
  // Two pixels: A, B, C as little-endian 16-bit.
  const Bytes data = {1, 0, 2, 0, 0x34, 0x12, 5, 0, 6, 0, 0x78, 0x56};
  const GenicamPart part{pfnc::kCoord3dAbc16, {2, 1}, data};
  Maps out({2, 1});
  const DepthUsed used = copy_depth({&part, 1}, {2, 1}, {}, out.buffers());
  EXPECT_EQ(used.depth, 4U);
  EXPECT_EQ(used.amplitude, 0U);
  EXPECT_EQ(out.depth, (Bytes{0x34, 0x12, 0x78, 0x56}));
}

TEST(GenicamBuffer, PointsWithIntensityGiveDepthAndAmplitude) {
  const Bytes data = {1, 0, 2, 0, 0x34, 0x12, 0xCD, 0xAB, 5, 0, 6, 0, 0x78, 0x56, 0x01, 0x02};
  const GenicamPart part{pfnc::kCoord3dAbcy16, {2, 1}, data};
  Maps out({2, 1});
  const DepthUsed used = copy_depth({&part, 1}, {2, 1}, {}, out.buffers());
  EXPECT_EQ(used.amplitude, 4U);
  EXPECT_EQ(out.depth, (Bytes{0x34, 0x12, 0x78, 0x56}));
  EXPECT_EQ(out.amplitude, (Bytes{0xCD, 0xAB, 0x01, 0x02}));
}

// IEEE 754 by hand: 1000.0 = 447A0000, 0.0, NaN = 7FC00000, 20000.0 = 469C4000, -1.0 = BF800000.
TEST(GenicamBuffer, FloatMillimetresBecomeStepsAndWhatIsNoDepthZero) {
  const Bytes data = {0x00, 0x00, 0x7A, 0x44, 0,    0,    0, 0, 0,    0,
                      0xC0, 0x7F, 0x00, 0x40, 0x9C, 0x46, 0, 0, 0x80, 0xBF};
  const GenicamPart part{pfnc::kCoord3dC32f, {5, 1}, data};
  Maps out({5, 1});
  ASSERT_EQ(copy_depth({&part, 1}, {5, 1}, {.scale_m = 0.001}, out.buffers()).depth, 10U);
  EXPECT_EQ(out.depth, (Bytes{0xA0, 0x0F, 0, 0, 0, 0, 0, 0, 0, 0})) << "1 m is 4000 steps";
  ASSERT_EQ(
      copy_depth({&part, 1}, {5, 1}, {.offset_m = 0.5, .invalid = 1000.0F}, out.buffers()).depth,
      10U);
  EXPECT_EQ(out.depth, (Bytes{0, 0, 0xD0, 0x07, 0, 0, 0, 0, 0xCC, 0x07}))
      << "invalid; 0.5 m; NaN; beyond 16 m; 0.499 m";
}

TEST(GenicamBuffer, FloatPointsKeepTheirC) {
  Bytes data(12, 0xEE);
  data[8] = 0, data[9] = 0, data[10] = 0x7A, data[11] = 0x44;
  const GenicamPart part{pfnc::kCoord3dAbc32f, {1, 1}, data};
  Maps out({1, 1});
  ASSERT_EQ(copy_depth({&part, 1}, {1, 1}, {}, out.buffers()).depth, 2U);
  EXPECT_EQ(out.depth, (Bytes{0xA0, 0x0F}));
}

// A camera may send its components in one multi-part buffer, in any order.
TEST(GenicamBuffer, PartsAreSortedByWhatTheyAre) {
  const Bytes range = {1, 2, 3, 4}, intensity = {5, 6, 7, 8}, sure = {0xFF, 0x80};
  const GenicamPart parts[] = {{pfnc::kMono16, {2, 1}, intensity},
                               {pfnc::kConfidence8, {2, 1}, sure},
                               {pfnc::kCoord3dC16, {2, 1}, range}};
  Maps out({2, 1});
  const DepthUsed used = copy_depth(parts, {2, 1}, {}, out.buffers());
  EXPECT_EQ(used.depth, 4U);
  EXPECT_EQ(out.depth, range);
  EXPECT_EQ(out.amplitude, intensity);
  EXPECT_EQ(out.confidence, (Bytes{0xFF, 0xFF, 0x80, 0x80}));
}

TEST(GenicamBuffer, PartsThatAreShortOrOfAnotherSizeAreLeftOut) {
  const Bytes range = {1, 2, 3, 4}, intensity = {5, 6, 7};
  Maps out({2, 1});
  const GenicamPart parts[] = {{pfnc::kCoord3dC16, {2, 1}, range},
                               {pfnc::kMono16, {2, 1}, intensity},
                               {pfnc::kConfidence16, {1, 2}, range}};
  const DepthUsed used = copy_depth(parts, {2, 1}, {}, out.buffers());
  EXPECT_EQ(used.depth, 4U);
  EXPECT_EQ(used.amplitude, 0U);
  EXPECT_EQ(used.confidence, 0U);
  const GenicamPart alone{pfnc::kMono16, {2, 1}, range};
  EXPECT_EQ(copy_depth({&alone, 1}, {2, 1}, {}, out.buffers()).amplitude, 0U) << "no depth";
  const GenicamPart cut{pfnc::kCoord3dC16, {2, 1}, std::span(range).first(3)};
  EXPECT_EQ(copy_depth({&cut, 1}, {2, 1}, {}, out.buffers()).depth, 0U);
}

TEST(GenicamBuffer, PackedSamplesOfSeveralRowsFollowEachOtherWithoutAGap) {
  // Mono10p, 2 x 2: 0x3FF, 0x001, 0x2AA, 0x154, bits from bit 0 on.
  const Bytes data = {0b11111111, 0b000001'11, 0b1010'0000, 0b00'101010, 0b01010101};
  Bytes out(8);
  ASSERT_TRUE(copy_picture(pfnc::kMono10p, {2, 2}, data, out));
  const std::vector<unsigned> samples = {0x3FF, 0x001, 0x2AA, 0x154};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(static_cast<unsigned>(out[2 * i] | out[2 * i + 1] << 8) >> 6, samples[i]);
  EXPECT_FALSE(copy_picture(pfnc::kMono10p, {2, 2}, std::span(data).first(4), out));
}

TEST(GenicamBuffer, FormatsTranslateBothWays) {
  for (const PixelFormat format :
       {PixelFormat::kRgb8, PixelFormat::kGray16, PixelFormat::kBayerGbrg8,
        PixelFormat::kBayerBggr16, PixelFormat::kDepth16}) {
    const auto codes = pfncs_of_format(format);
    EXPECT_FALSE(codes.empty());
    for (const std::uint32_t code : codes) EXPECT_EQ(format_of_pfnc(code), format) << code;
  }
  EXPECT_TRUE(pfncs_of_format(PixelFormat::kMjpeg).empty());
}

// Codes by libaravis' own table.
TEST(GenicamBuffer, CodesAreThoseOfTheNamingConvention) {
  EXPECT_EQ(format_of_pfnc(0x01100010), PixelFormat::kBayerGrbg16);
  EXPECT_EQ(sample_bits_of_pfnc(0x010A0054), 10);
  EXPECT_EQ(sample_bits_of_pfnc(pfnc::kMono16), 16);
  EXPECT_TRUE(is_float(pfnc::kCoord3dAbc32f));
  EXPECT_FALSE(is_float(pfnc::kCoord3dAbc16));
}

}  // namespace
}  // namespace mixrig::device
