// SPDX-License-Identifier: Apache-2.0
// libcamera's formats against the codes that its formats.yaml and the kernel's headers write.
#include "extras/libcamera/libcamera_format.h"

#include <gtest/gtest.h>

namespace mixrig::test {
namespace {

using device::fourcc;
using device::PixelFormat;

PixelFormat read_as(std::uint32_t drm, std::uint64_t modifier = 0, std::size_t planes = 1) {
  return device::format_of_fourcc(device::v4l2_of_drm(drm, modifier, planes));
}

TEST(LibcameraFormat, RgbIsNamedByTheOrderInAWordAndReadByTheOrderInMemory) {
  EXPECT_EQ(read_as(fourcc('B', 'G', '2', '4')), PixelFormat::kRgb8);
  EXPECT_EQ(read_as(fourcc('R', 'G', '2', '4')), PixelFormat::kBgr8);
}

TEST(LibcameraFormat, GreyAndBayerOfTenBitsAreWordsOrPackedByTheModifier) {
  const auto drm = fourcc('R', 'G', '1', '0');
  EXPECT_EQ(device::v4l2_of_drm(drm, 0, 1), fourcc('R', 'G', '1', '0'));
  EXPECT_EQ(device::v4l2_of_drm(drm, device::kDrmCsi2Packed, 1), fourcc('p', 'R', 'A', 'A'));
  EXPECT_EQ(read_as(drm), PixelFormat::kBayerRggb16);
  EXPECT_EQ(read_as(drm, device::kDrmCsi2Packed), PixelFormat::kBayerRggb16);
  EXPECT_EQ(read_as(fourcc('B', 'A', '1', '2'), device::kDrmCsi2Packed), PixelFormat::kBayerGrbg16);
  EXPECT_EQ(read_as(fourcc('R', '8', ' ', ' ')), PixelFormat::kGray8);
  EXPECT_EQ(read_as(fourcc('R', '1', '0', ' '), device::kDrmCsi2Packed), PixelFormat::kGray16);
}

TEST(LibcameraFormat, EveryPatternKeepsItsFirstRow) {
  EXPECT_EQ(read_as(fourcc('R', 'G', 'G', 'B')), PixelFormat::kBayerRggb8);
  EXPECT_EQ(read_as(fourcc('G', 'R', 'B', 'G')), PixelFormat::kBayerGrbg8);
  EXPECT_EQ(read_as(fourcc('G', 'B', 'R', 'G')), PixelFormat::kBayerGbrg8);
  EXPECT_EQ(read_as(fourcc('B', 'A', '8', '1')), PixelFormat::kBayerBggr8);
  EXPECT_EQ(read_as(fourcc('G', 'B', '1', '0')), PixelFormat::kBayerGbrg16);
  EXPECT_EQ(read_as(fourcc('B', 'G', '1', '2')), PixelFormat::kBayerBggr16);
}

TEST(LibcameraFormat, PlanesOfNv12MayLieInTwoBuffersAndNothingElseMay) {
  EXPECT_EQ(read_as(fourcc('N', 'V', '1', '2'), 0, 1), PixelFormat::kNv12);
  EXPECT_EQ(device::v4l2_of_drm(fourcc('N', 'V', '1', '2'), 0, 2), fourcc('N', 'M', '1', '2'));
  EXPECT_EQ(read_as(fourcc('Y', 'U', 'Y', 'V'), 0, 1), PixelFormat::kYuyv);
  EXPECT_EQ(device::v4l2_of_drm(fourcc('Y', 'U', 'Y', 'V'), 0, 2), 0U);
  EXPECT_EQ(device::v4l2_of_drm(fourcc('N', 'V', '1', '2'), 0, 3), 0U);
}

TEST(LibcameraFormat, WhatMixrigDoesNotReadIsZero) {
  EXPECT_EQ(device::v4l2_of_drm(fourcc('X', 'R', '2', '4'), 0, 1), 0U);
  // IPU3's packing, and a modifier that a format does not have.
  EXPECT_EQ(device::v4l2_of_drm(fourcc('R', 'G', '1', '0'), 0x010000000000000D, 1), 0U);
  EXPECT_EQ(device::v4l2_of_drm(fourcc('Y', 'U', 'Y', 'V'), device::kDrmCsi2Packed, 1), 0U);
}

}  // namespace
}  // namespace mixrig::test
