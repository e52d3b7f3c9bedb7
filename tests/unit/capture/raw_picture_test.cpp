// SPDX-License-Identifier: Apache-2.0
// A picture in its camera's own format: single pixels equal those of the decoder, and the picture
// is decoded on first use.
#include "hal/base/raw_picture.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "host/capture/capture/camera_picture.h"
#include "host/capture/capture/capture.h"
#include "tests/support/each_pixel.h"

namespace mixrig::capture {
namespace {

using device::ColorEncoding;
using device::PixelFormat;

device::Frame frame_of(PixelFormat format, Size size, const std::vector<std::uint8_t>& bytes,
                       std::size_t stride) {
  device::Frame frame{.format = format, .size = size, .stride_bytes = stride, .bytes = bytes};
  frame.memory = {.fd = 7, .set = 1};
  return frame;
}

std::vector<std::uint8_t> random_bytes(std::size_t count) {
  std::mt19937 generator(5);
  std::vector<std::uint8_t> bytes(count);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(generator());
  return bytes;
}

/// Pixels that differ from what the decoder makes.
int differing(const ColorSettings& settings, const device::Frame& frame) {
  ColorDecoder decoder(settings);
  const auto raw = decoder.raw(frame);
  Image<Rgb8> decoded;
  if (!raw || !decoder.decode(frame, decoded)) return -1;
  int count = 0;
  for (const auto [x, y] : test::each_pixel(decoded))
    count += !(pixel_of(*raw, x, y) == decoded.at(x, y));
  return count;
}

std::vector<ColorEncoding> yuv_encodings() {
  std::vector<ColorEncoding> all;
  for (const auto matrix :
       {device::YuvMatrix::kBt601, device::YuvMatrix::kBt709, device::YuvMatrix::kBt2020})
    for (const auto range : {device::SampleRange::kUsual, device::SampleRange::kFull})
      all.push_back({.matrix = matrix, .range = range});
  return all;
}

// Every luma with every fifth value of both chroma samples.
TEST(RawPicture, EveryYuvValueBecomesWhatTheDecoderMakesOfIt) {
  constexpr int kSteps = 52;
  std::vector<std::uint8_t> bytes;
  for (const auto [v, u] : test::each_pixel({0, 0}, {kSteps, kSteps}))
    for (int y = 0; y < 256; y += 2)
      for (const int value : {y, 5 * u, y + 1, 5 * v})
        bytes.push_back(static_cast<std::uint8_t>(value));
  for (const ColorEncoding& encoding : yuv_encodings())
    EXPECT_EQ(differing({.encoding = encoding},
                        frame_of(PixelFormat::kYuyv, {256, kSteps * kSteps}, bytes, 512)),
              0)
        << static_cast<int>(encoding.matrix) << static_cast<int>(encoding.range);
}

TEST(RawPicture, PixelsOfOddPicturesAreThoseOfTheDecoder) {
  const auto bytes = random_bytes(40 * 40);
  for (const Size size : {Size{17, 9}, Size{16, 8}, Size{1, 1}, Size{1, 5}, Size{7, 1}})
    for (const PixelFormat format :
         {PixelFormat::kYuyv, PixelFormat::kNv12, PixelFormat::kGray8, PixelFormat::kBayerRggb8,
          PixelFormat::kBayerGrbg8, PixelFormat::kBayerGbrg8, PixelFormat::kBayerBggr8}) {
      const auto frame = frame_of(format, size, bytes, 40);
      EXPECT_EQ(differing({}, frame), 0) << device::name(format) << size.width;
      ColorSettings linear{.gains = {1.3, 1, 0.7}};
      linear.encoding.transfer = device::Transfer::kLinear;
      EXPECT_EQ(differing(linear, frame), 0) << device::name(format) << size.width << " linear";
    }
}

TEST(RawPicture, HasNoFormForFilesAndDeepSamplesAndBytesThatLack) {
  const auto bytes = random_bytes(64);
  const ColorDecoder decoder;
  for (const PixelFormat format : {PixelFormat::kMjpeg, PixelFormat::kGray16, PixelFormat::kRgb8,
                                   PixelFormat::kBayerRggb16, PixelFormat::kDepth16})
    EXPECT_FALSE(decoder.raw(frame_of(format, {4, 2}, bytes, 12))) << device::name(format);
  EXPECT_FALSE(decoder.raw(frame_of(PixelFormat::kGray8, {8, 9}, bytes, 8)));
  EXPECT_TRUE(decoder.raw(frame_of(PixelFormat::kGray8, {8, 8}, bytes, 8)));
}

TEST(CameraPicture, KeepsItsFrameAndIsDecodedOnceSomebodyLooks) {
  const auto bytes = random_bytes(32);
  const auto frame =
      std::make_shared<device::Frame>(frame_of(PixelFormat::kGray8, {8, 4}, bytes, 8));
  const ColorDecoder decoder;
  const auto picture = std::make_shared<CameraPicture>();
  ASSERT_TRUE(picture->hold(frame, decoder));
  EXPECT_EQ(frame.use_count(), 2);
  EXPECT_EQ(picture->raw().memory.fd, 7);
  Capture capture;
  capture.picture = picture;
  EXPECT_EQ(plate_of(capture).at(3, 2), (Rgb8{bytes[19], bytes[19], bytes[19]}));
  EXPECT_EQ(&plate_of(capture), &picture->decoded());
  capture.recycle();
  EXPECT_EQ(picture.use_count(), 1) << "an unused capture keeps no buffer of a camera";
  picture->recycle();
  EXPECT_EQ(frame.use_count(), 1);
}

TEST(CameraPicture, HoldsNoFrameWhoseMemoryIsNotShared) {
  const auto bytes = random_bytes(32);
  const auto frame =
      std::make_shared<device::Frame>(frame_of(PixelFormat::kGray8, {8, 4}, bytes, 8));
  frame->memory = {};
  CameraPicture picture;
  EXPECT_FALSE(picture.hold(frame, ColorDecoder()));
  EXPECT_EQ(frame.use_count(), 1);
}

}  // namespace
}  // namespace mixrig::capture
