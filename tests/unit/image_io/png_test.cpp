// SPDX-License-Identifier: Apache-2.0
// PNG reading of bytes assembled by hand, round trips, and damaged files.
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/hand_png.h"
#include "tests/support/little_memory.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::image_io {
namespace {

using test::bytes_of;
using test::hand_png;

constexpr int kGray = 0, kRgb = 2, kPalette = 3, kGrayAlpha = 4, kRgba = 6;

Result<void> decode_png(const std::string& bytes, Image<Rgb8>& image) {
  return decode_rgb8(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), "x.png",
                     image);
}

TEST(PictureMemory, APictureThatHasNoMemoryIsItsError) {
  if (!kLimitsMemory) GTEST_SKIP() << "memory is not limited under a sanitizer";
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "large.png";
  ASSERT_TRUE(write_png(path, Image<std::uint8_t>({6000, 6000}).view()));
  Image<Rgb8> image;
  EXPECT_EXIT(
      test::say_with_little_memory(std::size_t{64} << 20, [&] { return read_rgb8(path, image); }),
      testing::ExitedWithCode(0), "large.png': no memory is left: stop other programs");
  EXPECT_TRUE(read_rgb8(path, image)) << "with memory it is read";
}

TEST(PngRead, Rgb8IsTakenAsItIs) {
  Image<Rgb8> image;
  ASSERT_TRUE(decode_png(
      hand_png(2, 2, 8, kRgb, bytes_of({0, 1, 2, 3, 4, 5, 6, 0, 7, 8, 9, 255, 254, 253})), image));
  ASSERT_EQ(image.size(), (Size{2, 2}));
  EXPECT_EQ(image.at(0, 0), (Rgb8{1, 2, 3}));
  EXPECT_EQ(image.at(1, 0), (Rgb8{4, 5, 6}));
  EXPECT_EQ(image.at(0, 1), (Rgb8{7, 8, 9}));
  EXPECT_EQ(image.at(1, 1), (Rgb8{255, 254, 253}));
}

TEST(PngRead, EveryColourTypeBecomesRgb8) {
  Image<Rgb8> image;
  ASSERT_TRUE(decode_png(hand_png(1, 1, 8, kRgba, bytes_of({0, 10, 20, 30, 0})), image));
  EXPECT_EQ(image.at(0, 0), (Rgb8{10, 20, 30})) << "transparency is dropped, colour stays";
  ASSERT_TRUE(decode_png(hand_png(2, 1, 1, kGray, bytes_of({0, 0x40})), image));
  EXPECT_EQ(image.at(0, 0), (Rgb8{0, 0, 0}));
  EXPECT_EQ(image.at(1, 0), (Rgb8{255, 255, 255}));
  const std::string palette = test::chunk("PLTE", bytes_of({1, 2, 3, 40, 50, 60}));
  ASSERT_TRUE(decode_png(hand_png(2, 1, 8, kPalette, bytes_of({0, 1, 0}), palette), image));
  EXPECT_EQ(image.at(0, 0), (Rgb8{40, 50, 60}));
  EXPECT_EQ(image.at(1, 0), (Rgb8{1, 2, 3}));
  ASSERT_TRUE(decode_png(hand_png(1, 1, 16, kRgb, bytes_of({0, 255, 255, 128, 128, 0, 0})), image));
  EXPECT_EQ(image.at(0, 0), (Rgb8{255, 128, 0})) << "16 bit scaled to 8";
}

TEST(PngRead, Gray16KeepsEveryBit) {
  const test::TemporaryFolder folder;
  Image<std::uint16_t> image;
  const auto deep =
      folder.write("d.png", hand_png(3, 1, 16, kGray, bytes_of({0, 0, 1, 1, 0, 255, 254})));
  ASSERT_TRUE(read_gray16(deep, image));
  EXPECT_EQ(image.at(0, 0), 1);
  EXPECT_EQ(image.at(1, 0), 256);
  EXPECT_EQ(image.at(2, 0), 65534);
  const auto flat = folder.write("f.png", hand_png(2, 1, 8, kGray, bytes_of({0, 7, 255})));
  ASSERT_TRUE(read_gray16(flat, image));
  EXPECT_EQ(image.at(0, 0), 7);
  EXPECT_EQ(image.at(1, 0), 255) << "8 bit is not scaled";
}

TEST(PngRead, DepthInColourOrWrongDepthIsRefusedWithTheFileName) {
  const test::TemporaryFolder folder;
  Image<std::uint16_t> deep;
  Image<std::uint8_t> flat;
  const auto color = folder.write("c.png", hand_png(1, 1, 8, kRgb, bytes_of({0, 1, 2, 3})));
  const auto alpha = folder.write("a.png", hand_png(1, 1, 8, kGrayAlpha, bytes_of({0, 1, 2})));
  const auto wide = folder.write("w.png", hand_png(1, 1, 16, kGray, bytes_of({0, 1, 2})));
  for (const auto& path : {color, alpha}) {
    const auto result = read_gray16(path, deep);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kFormat);
    EXPECT_NE(result.error().context.find(path.string()), std::string::npos);
  }
  EXPECT_FALSE(read_gray8(color, flat));
  EXPECT_FALSE(read_gray8(wide, flat));
}

TEST(PngRead, EveryTruncationIsRefused) {
  const std::string whole = hand_png(4, 4, 8, kGray, std::string(4 * 5, '\0'));
  Image<Rgb8> image;
  ASSERT_TRUE(decode_png(whole, image));
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_FALSE(decode_png(whole.substr(0, length), image)) << length;
}

TEST(PngRead, ChangedBytesNeverCrash) {
  const std::string whole = hand_png(16, 16, 8, kRgb, std::string(16 * 49, '\0'));
  std::mt19937 random(1);
  Image<Rgb8> image;
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    for (int flips = 0; flips < 3; ++flips)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    if (decode_png(bytes, image)) {
      EXPECT_FALSE(image.empty());
    }
  }
}

TEST(PngRead, HugePictureInATinyFileIsRefusedBeforeMemoryIsTaken) {
  Image<Rgb8> image;
  const auto large = decode_png(hand_png(16000, 16000, 8, kRgb, ""), image);
  ASSERT_FALSE(large);
  EXPECT_NE(large.error().context.find("too early"), std::string::npos) << large.error().context;
  EXPECT_FALSE(decode_png(hand_png(100000, 1, 8, kRgb, ""), image));
}

TEST(PngRead, MissingFileIsNotFound) {
  Image<Rgb8> image;
  const auto result = read_rgb8("/nonexistent/x.png", image);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kNotFound);
}

TEST(PngWrite, ReadsBackTheSameValuesAndLeavesNoPartialFile) {
  const test::TemporaryFolder folder;
  Image<std::uint16_t> deep(Size{5, 3});
  Image<Rgb8> color(Size{5, 3});
  Image<std::uint8_t> flat(Size{5, 3});
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      deep.at(x, y) = static_cast<std::uint16_t>(x * 13107 + y);
      color.at(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 200};
      flat.at(x, y) = static_cast<std::uint8_t>(x * 50 + y);
    }
  ASSERT_TRUE(write_png(folder / "deep.png", deep.view()));
  ASSERT_TRUE(write_png(folder / "color.png", color.view()));
  ASSERT_TRUE(write_png(folder / "flat.png", flat.view()));
  Image<std::uint16_t> deep_back;
  Image<Rgb8> color_back;
  Image<std::uint8_t> flat_back;
  ASSERT_TRUE(read_gray16(folder / "deep.png", deep_back));
  ASSERT_TRUE(read_rgb8(folder / "color.png", color_back));
  ASSERT_TRUE(read_gray8(folder / "flat.png", flat_back));
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      EXPECT_EQ(deep_back.at(x, y), deep.at(x, y));
      EXPECT_EQ(color_back.at(x, y), color.at(x, y));
      EXPECT_EQ(flat_back.at(x, y), flat.at(x, y));
    }
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().extension(), ".png");
}

TEST(PngWrite, IntoAMissingFolderFailsWithTheName) {
  const test::TemporaryFolder folder;
  const auto result = write_png(folder / "no/such/x.png", Image<std::uint8_t>(Size{1, 1}).view());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kIo);
  EXPECT_NE(result.error().context.find("no/such/x.png"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::image_io
