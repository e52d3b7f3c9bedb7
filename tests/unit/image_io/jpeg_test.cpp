// SPDX-License-Identifier: Apache-2.0
// JPEG reading against files that libjpeg wrote from known pixels.
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <jpeglib.h>

#include "host/math/image_io/image_io.h"

namespace mixrig::image_io {
namespace {

/// A 32x16 picture of two colours, left and right, that meet at a block border.
std::string two_halves(Rgb8 left, Rgb8 right) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* out = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &out, &size);
  info.image_width = 32;
  info.image_height = 16;
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 100, TRUE);
  jpeg_start_compress(&info, TRUE);
  std::vector<Rgb8> row(32, left);
  std::fill(row.begin() + 16, row.end(), right);
  auto* samples = reinterpret_cast<JSAMPROW>(row.data());
  while (info.next_scanline < info.image_height) jpeg_write_scanlines(&info, &samples, 1);
  jpeg_finish_compress(&info);
  std::string bytes(reinterpret_cast<char*>(out), size);
  jpeg_destroy_compress(&info);
  std::free(out);
  return bytes;
}

Result<void> decode_jpeg(const std::string& bytes, Image<Rgb8>& image) {
  return decode_rgb8(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), "x.jpg",
                     image);
}

void expect_close(Rgb8 a, Rgb8 b) {
  EXPECT_NEAR(a.r, b.r, 3);
  EXPECT_NEAR(a.g, b.g, 3);
  EXPECT_NEAR(a.b, b.b, 3);
}

TEST(JpegRead, ContentDecidesAndPixelsAreThere) {
  const Rgb8 left{200, 30, 60}, right{20, 180, 90};
  Image<Rgb8> image;
  ASSERT_TRUE(decode_jpeg(two_halves(left, right), image));
  ASSERT_EQ(image.size(), (Size{32, 16}));
  expect_close(image.at(2, 3), left);
  expect_close(image.at(30, 12), right);
}

TEST(JpegRead, EveryTruncationIsRefusedInsteadOfPaintedOver) {
  const std::string whole = two_halves({200, 30, 60}, {20, 180, 90});
  Image<Rgb8> image;
  for (std::size_t length = 0; length + 2 < whole.size(); ++length) {
    const auto result = decode_jpeg(whole.substr(0, length), image);
    ASSERT_FALSE(result) << length;
    EXPECT_EQ(result.error().code, ErrorCode::kFormat);
    EXPECT_NE(result.error().context.find("x.jpg"), std::string::npos);
  }
}

TEST(JpegRead, ChangedBytesNeverCrash) {
  const std::string whole = two_halves({200, 30, 60}, {20, 180, 90});
  std::mt19937 random(2);
  Image<Rgb8> image;
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    for (int flips = 0; flips < 3; ++flips)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    if (decode_jpeg(bytes, image)) {
      EXPECT_FALSE(image.empty());
    }
  }
}

}  // namespace
}  // namespace mixrig::image_io
