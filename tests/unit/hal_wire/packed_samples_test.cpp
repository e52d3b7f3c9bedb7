// SPDX-License-Identifier: Apache-2.0
// Bytes are written by hand from the layouts in Documentation/userspace-api/media/v4l of the kernel
// (pixfmt-srggb10p, pixfmt-srggb12p, pixfmt-yuv-luma) and of the GenICam PFNC (Mono10p).
#include "hal/wire/camera/packed_samples.h"

#include <vector>

#include <gtest/gtest.h>

namespace mixrig::device {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<unsigned> unpacked(const PackedSamples& layout, const Bytes& in) {
  Bytes out(2 * layout.size.area());
  EXPECT_TRUE(unpack_samples(layout, in, out));
  std::vector<unsigned> samples;
  for (std::size_t i = 0; i < out.size(); i += 2)
    samples.push_back(static_cast<unsigned>(out[i] | out[i + 1] << 8) >> (16 - layout.bits));
  return samples;
}

// 0x3FF, 0x001, 0x2AA, 0x154 of 10 bits; the samples of 12 are 0xFFF, 0x001.
const std::vector<unsigned> kTen = {0x3FF, 0x001, 0x2AA, 0x154}, kTwelve = {0xFFF, 0x001};

TEST(PackedSamples, MipiRaw10KeepsTheLowBitsInTheFifthByteFirstSampleLowest) {
  // High: FF 00 AA 55; low: 11, 01, 10, 00 from bit 0 on.
  const Bytes bytes = {0xFF, 0x00, 0xAA, 0x55, 0b00'10'01'11};
  EXPECT_EQ(unpacked({SamplePacking::kMipi, 10, {4, 1}, 5}, bytes), kTen);
}

TEST(PackedSamples, MipiRaw12KeepsTheLowBitsInTheThirdByteFirstSampleLowest) {
  EXPECT_EQ(unpacked({SamplePacking::kMipi, 12, {2, 1}, 3}, {0xFF, 0x00, 0x1F}), kTwelve);
}

TEST(PackedSamples, WordsHoldTheSampleInTheirLowBits) {
  EXPECT_EQ(unpacked({SamplePacking::kWords, 10, {4, 1}, 8},
                     {0xFF, 0x03, 0x01, 0x00, 0xAA, 0x02, 0x54, 0x01}),
            kTen);
  EXPECT_EQ(unpacked({SamplePacking::kWords, 12, {2, 1}, 4}, {0xFF, 0xFF, 0x01, 0x00}), kTwelve)
      << "bits above the sample are no part of it";
}

TEST(PackedSamples, BitStreamsBeginAtTheTopOrAtTheBottomOfAByte) {
  // 1111111111 0000000001 1010101010 0101010100
  const Bytes big = {0b11111111, 0b11000000, 0b00011010, 0b10101001, 0b01010100};
  EXPECT_EQ(unpacked({SamplePacking::kBig, 10, {4, 1}, 5}, big), kTen);
  // The bits of each sample from bit 0 of byte 0 on.
  const Bytes little = {0b11111111, 0b000001'11, 0b1010'0000, 0b00'101010, 0b01010101};
  EXPECT_EQ(unpacked({SamplePacking::kLittle, 10, {4, 1}, 5}, little), kTen);
}

TEST(PackedSamples, FullScaleIs65535AndZeroIsZero) {
  Bytes out(4);
  ASSERT_TRUE(unpack_samples({SamplePacking::kWords, 10, {2, 1}, 4}, Bytes{0xFF, 3, 0, 0}, out));
  EXPECT_EQ(out, (Bytes{0xFF, 0xFF, 0, 0}));
  ASSERT_TRUE(unpack_samples({SamplePacking::kWords, 14, {2, 1}, 4}, Bytes{0xFF, 0x3F, 1, 0}, out));
  EXPECT_EQ(out, (Bytes{0xFF, 0xFF, 4, 0}));
}

TEST(PackedSamples, RowsBeginAtTheirStride) {
  EXPECT_EQ(unpacked({SamplePacking::kMipi, 12, {2, 2}, 4}, {0xFF, 0, 0x1F, 99, 0, 0xFF, 0xF1}),
            (std::vector<unsigned>{0xFFF, 0x001, 0x001, 0xFFF}));
}

TEST(PackedSamples, WhatIsShortIsRefused) {
  Bytes out(8);
  EXPECT_FALSE(unpack_samples({SamplePacking::kMipi, 10, {4, 1}, 5}, Bytes(4), out));
  EXPECT_FALSE(unpack_samples({SamplePacking::kMipi, 10, {4, 1}, 4}, Bytes(5), out));
  Bytes two_rows(16);
  EXPECT_FALSE(unpack_samples({SamplePacking::kMipi, 10, {4, 2}, 5}, Bytes(9), two_rows));
  EXPECT_FALSE(unpack_samples({SamplePacking::kMipi, 14, {4, 1}, 7}, Bytes(9), out));
  Bytes small(7);
  EXPECT_FALSE(unpack_samples({SamplePacking::kMipi, 10, {4, 1}, 5}, Bytes(5), small));
  EXPECT_FALSE(unpack_samples({SamplePacking::kNone, 16, {4, 1}, 8}, Bytes(8), out));
}

}  // namespace
}  // namespace mixrig::device
