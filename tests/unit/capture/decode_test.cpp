// SPDX-License-Identifier: Apache-2.0
#include "host/capture/decode.h"

#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace mixrig::capture {
namespace {

using device::PixelFormat;

device::Frame frame(PixelFormat format, Size size, std::span<const std::uint8_t> bytes,
                    std::size_t stride = 0) {
  device::Frame f;
  f.format = format;
  f.size = size;
  f.stride_bytes = stride > 0 ? stride : device::row_bytes(format, size.width);
  f.bytes = bytes;
  return f;
}

void expect_near(Rgb8 a, Rgb8 b) {
  EXPECT_NEAR(a.r, b.r, 2);
  EXPECT_NEAR(a.g, b.g, 2);
  EXPECT_NEAR(a.b, b.b, 2);
}

// The colour bars of ITU-R BT.601 in 8-bit limited range, by the recommendation's own equations.
TEST(Decode, YuyvGivesTheColourBars) {
  // red (81, 90, 240), green (145, 54, 34): one pair each
  const std::vector<std::uint8_t> bytes = {81, 90, 81, 240, 145, 54, 145, 34};
  Image<Rgb8> out;
  ASSERT_TRUE(decode_rgb8(frame(PixelFormat::kYuyv, {4, 1}, bytes), out));
  expect_near(out.at(0, 0), {255, 0, 0});
  expect_near(out.at(1, 0), {255, 0, 0});
  expect_near(out.at(3, 0), {0, 255, 0});
}

TEST(Decode, Nv12GivesBlueWhiteAndBlack) {
  // 4x2: left pair blue (41, 240, 110), right pair white over black (235/16, 128, 128)
  const std::vector<std::uint8_t> bytes = {41, 41, 235, 235, 41, 41, 16, 16, 240, 110, 128, 128};
  Image<Rgb8> out;
  ASSERT_TRUE(decode_rgb8(frame(PixelFormat::kNv12, {4, 2}, bytes), out));
  expect_near(out.at(0, 1), {0, 0, 255});
  expect_near(out.at(2, 0), {255, 255, 255});
  expect_near(out.at(3, 1), {0, 0, 0});
}

/// BT.601 in exact arithmetic: limited range, 8 bit.
Eigen::Vector3d exact_rgb(int y, int u, int v) {
  const double luma = (y - 16) / 219.0, blue = (u - 128) / 224.0, red = (v - 128) / 224.0;
  const double kr = 0.299, kb = 0.114, kg = 1 - kr - kb;
  const Eigen::Vector3d rgb(luma + 2 * (1 - kr) * red,
                            luma - 2 * kb * (1 - kb) / kg * blue - 2 * kr * (1 - kr) / kg * red,
                            luma + 2 * (1 - kb) * blue);
  return 255 * rgb.cwiseMax(0).cwiseMin(1);
}

void expect_exact(Rgb8 pixel, int y, int u, int v) {
  const Eigen::Vector3d exact = exact_rgb(y, u, v);
  ASSERT_NEAR(pixel.r, exact[0], 1) << y << " " << u << " " << v;
  ASSERT_NEAR(pixel.g, exact[1], 1) << y << " " << u << " " << v;
  ASSERT_NEAR(pixel.b, exact[2], 3) << y << " " << u << " " << v;
}

TEST(Decode, EveryYuvFollowsBt601) {
  std::vector<std::uint8_t> yuyv(512), nv12(256 + 256);
  Image<Rgb8> out;
  for (int u = 0; u < 256; u += 3)
    for (int v = 0; v < 256; v += 3) {
      for (int x = 0; x < 256; ++x) {
        const auto index = static_cast<std::size_t>(x);
        yuyv[2 * index] = nv12[index] = static_cast<std::uint8_t>(x);
        yuyv[2 * index + 1] = nv12[256 + index] = static_cast<std::uint8_t>(x % 2 == 0 ? u : v);
      }
      ASSERT_TRUE(decode_rgb8(frame(PixelFormat::kYuyv, {256, 1}, yuyv), out));
      for (int x = 0; x < 256; ++x) expect_exact(out.at(x, 0), x, u, v);
      ASSERT_TRUE(decode_rgb8(frame(PixelFormat::kNv12, {256, 1}, nv12), out));
      for (int x = 0; x < 256; ++x) expect_exact(out.at(x, 0), x, u, v);
    }
}

// Widths around the blocks of vector instructions and of the decoder; rows are padded.
TEST(Decode, YuvOfAnyWidthReadsItsOwnSamples) {
  std::mt19937 random(3);
  for (const int width : {1, 2, 3, 7, 15, 16, 17, 31, 33, 640, 1023, 1024, 1025, 2050}) {
    for (const PixelFormat format : {PixelFormat::kYuyv, PixelFormat::kNv12}) {
      const std::size_t stride = device::row_bytes(format, width + width % 2) + 6;
      std::vector<std::uint8_t> bytes(device::image_bytes(format, {width, 3}, stride));
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      Image<Rgb8> out;
      ASSERT_TRUE(decode_rgb8(frame(format, {width, 3}, bytes, stride), out));
      for (std::size_t y = 0; y < 3; ++y)
        for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
          const bool packed = format == PixelFormat::kYuyv;
          const std::size_t luma = y * stride + (packed ? 2 * x : x);
          const std::size_t u =
              packed ? y * stride + x / 2 * 4 + 1 : (3 + y / 2) * stride + x / 2 * 2;
          expect_exact(out.at(static_cast<int>(x), static_cast<int>(y)), bytes[luma], bytes[u],
                       bytes[u + (packed ? 2 : 1)]);
        }
    }
  }
}

TEST(Decode, Nv12WithHalfAPairOfChromaIsRefused) {
  const std::vector<std::uint8_t> bytes(device::image_bytes(PixelFormat::kNv12, {5, 2}, 5));
  Image<Rgb8> out;
  EXPECT_FALSE(decode_rgb8(frame(PixelFormat::kNv12, {5, 2}, bytes), out));
}

TEST(Decode, PackedColoursKeepTheirOrderAndStride) {
  const std::vector<std::uint8_t> bytes = {1, 2, 3, 4, 5, 6, 99, 99, 7, 8, 9, 10, 11, 12, 99, 99};
  Image<Rgb8> out;
  ASSERT_TRUE(decode_rgb8(frame(PixelFormat::kRgb8, {2, 2}, bytes, 8), out));
  EXPECT_EQ(out.at(1, 1), (Rgb8{10, 11, 12}));
  ASSERT_TRUE(decode_rgb8(frame(PixelFormat::kBgr8, {2, 2}, bytes, 8), out));
  EXPECT_EQ(out.at(0, 1), (Rgb8{9, 8, 7}));
}

TEST(Decode, GrayKeepsTheUpperByte) {
  const std::vector<std::uint8_t> bytes = {0xFF, 0x12, 0x00, 0x80};
  Image<Rgb8> out;
  ASSERT_TRUE(decode_rgb8(frame(PixelFormat::kGray16, {2, 1}, bytes), out));
  EXPECT_EQ(out.at(0, 0), (Rgb8{0x12, 0x12, 0x12}));
  EXPECT_EQ(out.at(1, 0), (Rgb8{0x80, 0x80, 0x80}));
}

TEST(Decode, AFlatColourBehindEveryBayerPatternIsThatColour) {
  struct Pattern {
    PixelFormat format;
    int red_x, red_y;
  };
  for (const Pattern& p :
       {Pattern{PixelFormat::kBayerRggb8, 0, 0}, Pattern{PixelFormat::kBayerGrbg8, 1, 0},
        Pattern{PixelFormat::kBayerGbrg8, 0, 1}, Pattern{PixelFormat::kBayerBggr8, 1, 1}}) {
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 7; ++x) {
        const bool row = y % 2 == p.red_y, column = x % 2 == p.red_x;
        bytes.push_back(row && column ? 200 : row != column ? 100 : 50);
      }
    Image<Rgb8> out;
    ASSERT_TRUE(decode_rgb8(frame(p.format, {7, 6}, bytes), out));
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 7; ++x)
        EXPECT_EQ(out.at(x, y), (Rgb8{200, 100, 50})) << name(p.format) << x << y;
  }
}

TEST(Decode, ShortFramesAndDepthAreRefused) {
  Image<Rgb8> out;
  for (int format = 1; format < device::kPixelFormats; ++format) {
    const std::vector<std::uint8_t> bytes(
        device::image_bytes(static_cast<PixelFormat>(format), {8, 8},
                            device::row_bytes(static_cast<PixelFormat>(format), 8)) /
        2);
    EXPECT_FALSE(decode_rgb8(frame(static_cast<PixelFormat>(format), {8, 8}, bytes), out))
        << format;
  }
  const std::vector<std::uint8_t> depth(128);
  EXPECT_FALSE(decode_rgb8(frame(PixelFormat::kDepth16, {8, 8}, depth), out));
}

}  // namespace
}  // namespace mixrig::capture
