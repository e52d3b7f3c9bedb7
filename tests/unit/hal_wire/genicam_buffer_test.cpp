// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/genicam_buffer.h"

#include <vector>

#include <gtest/gtest.h>

namespace mixrig::device {
namespace {

TEST(GenicamBuffer, DeclaredSizesFollowTheCodesBitsPerPixel) {
  // Bits 16..23 of a PFNC code are the bits per pixel.
  for (const std::uint32_t code :
       {pfnc::kMono8, pfnc::kMono16, pfnc::kRgb8, pfnc::kBgr8, pfnc::kBayerRg8, pfnc::kYuyv,
        pfnc::kCoord3dC16, pfnc::kCoord3dAbc16})
    EXPECT_EQ(declared_bytes(code, {640, 480}), 640U * 480U * ((code >> 16 & 0xFF) / 8))
        << std::hex << code;
  EXPECT_EQ(declared_bytes(0x12345678, {640, 480}), 0U);
  EXPECT_EQ(declared_bytes(pfnc::kMono8, {0, 480}), 0U);
  EXPECT_EQ(declared_bytes(pfnc::kMono8, {1 << 30, 1 << 30}), 0U);
}

TEST(GenicamBuffer, AnOversizedPartIsCutToItsGeometry) {
  std::vector<std::uint8_t> data(4 * 3 * 2 + 704, 0xEE), out(4 * 3 * 2);
  for (std::size_t i = 0; i < 24; ++i) data[i] = static_cast<std::uint8_t>(i);
  ASSERT_TRUE(copy_picture(pfnc::kCoord3dC16, {4, 3}, data, out));
  EXPECT_EQ(out[23], 23);
}

TEST(GenicamBuffer, AShortPartIsRefusedAndNothingIsRead) {
  const std::vector<std::uint8_t> data(23);
  std::vector<std::uint8_t> out(24, 7);
  EXPECT_FALSE(copy_picture(pfnc::kCoord3dC16, {4, 3}, data, out));
  EXPECT_EQ(out[0], 7);
  EXPECT_FALSE(copy_picture(pfnc::kMono8, {4, 3}, {}, out));
}

TEST(GenicamBuffer, ASmallTargetIsRefused) {
  const std::vector<std::uint8_t> data(1000);
  std::vector<std::uint8_t> out(23);
  EXPECT_FALSE(copy_picture(pfnc::kCoord3dC16, {4, 3}, data, out));
  EXPECT_FALSE(copy_picture(pfnc::kCoord3dAbc16, {4, 3}, data, out));
}

TEST(GenicamBuffer, OfPointsOnlyTheDepthIsKept) {
  // Two pixels: A, B, C as little-endian 16-bit.
  const std::vector<std::uint8_t> data = {1, 0, 2, 0, 0x34, 0x12, 5, 0, 6, 0, 0x78, 0x56};
  std::vector<std::uint8_t> out(4);
  ASSERT_TRUE(copy_picture(pfnc::kCoord3dAbc16, {2, 1}, data, out));
  EXPECT_EQ(out, (std::vector<std::uint8_t>{0x34, 0x12, 0x78, 0x56}));
}

TEST(GenicamBuffer, FormatsTranslateBothWays) {
  for (const PixelFormat format :
       {PixelFormat::kRgb8, PixelFormat::kGray16, PixelFormat::kBayerGbrg8, PixelFormat::kDepth16})
    EXPECT_EQ(format_of_pfnc(pfnc_of_format(format)), format);
  EXPECT_EQ(pfnc_of_format(PixelFormat::kMjpeg), 0U);
}

}  // namespace
}  // namespace mixrig::device
