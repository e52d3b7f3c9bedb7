// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/pairs.h"

#include <cmath>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::bench {
namespace {

constexpr Size kPairSize{96, 64};

/// Disparity 40 left of a slanted line, 20 right of it; colours by the same line.
Pair slanted() {
  Pair pair{"slanted", Image<Rgb8>(kPairSize), Image<float>(kPairSize)};
  for (int y = 0; y < kPairSize.height; ++y)
    for (int x = 0; x < kPairSize.width; ++x) {
      const bool left = x < 37 + y / 3;
      pair.disparity.row(y)[x] = left ? 40.0F : 20.0F;
      pair.color.row(y)[x] = left ? Rgb8{200, 60, 40} : Rgb8{50, 90, 180};
    }
  return pair;
}

int wrong(const Image<float>& found, const Image<float>& truth) {
  int count = 0;
  for (int y = 0; y < truth.height(); ++y)
    for (int x = 0; x < truth.width(); ++x)
      count += std::abs(found.at(x, y) - truth.at(x, y)) > 1 ? 1 : 0;
  return count;
}

TEST(Decimated, TakesTheMiddlesOfBlocks) {
  Image<float> values({16, 8});
  values.at(4, 4) = 7, values.at(12, 4) = 9;
  const Image<float> low = decimated(values, 8);
  ASSERT_EQ(low.size(), (Size{2, 1}));
  EXPECT_EQ(low.at(0, 0), 7);
  EXPECT_EQ(low.at(1, 0), 9);
}

TEST(SidesByColor, FindsTheSideOfAStep) {
  const Pair pair = slanted();
  const Image<float> low = decimated(pair.disparity, 8);
  EXPECT_LE(wrong(sides_by_color(low, pair.color), pair.disparity), kPairSize.height / 4);
}

TEST(SidesByColor, UnknownStaysUnknown) {
  const Image<float> found = sides_by_color(Image<float>({4, 4}), Image<Rgb8>({32, 32}));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) EXPECT_EQ(found.at(x, y), 0);
}

TEST(Pairs, AreReadFromTheirFiles) {
  const test::TemporaryFolder folder;
  for (const char* name : {"art", "aloe", "motorcycle"})
    std::filesystem::create_directories(folder / name);
  const Image<Rgb8> color({16, 8}, {1, 2, 3});
  const Image<std::uint8_t> disparity({16, 8}, 30);
  const Image<std::uint16_t> fine({16, 8}, 30 * 256 + 128);
  ASSERT_TRUE(image_io::write_png(folder / "art/color.png", color.view()));
  ASSERT_TRUE(image_io::write_png(folder / "art/disparity.png", disparity.view()));
  ASSERT_TRUE(image_io::write_png(folder / "aloe/aloeL.jpg", color.view()));  // told by content
  ASSERT_TRUE(image_io::write_png(folder / "aloe/aloeGT.png", disparity.view()));
  ASSERT_TRUE(image_io::write_png(folder / "motorcycle/motorcycle_left.png", color.view()));
  EXPECT_FALSE(read_pairs(folder.path())) << "one is missing";
  ASSERT_TRUE(image_io::write_png(folder / "motorcycle/disp_x256.png", fine.view()));
  const auto pairs = read_pairs(folder.path());
  ASSERT_TRUE(pairs) << to_line(pairs.error());
  ASSERT_EQ(pairs->size(), 3U);
  EXPECT_EQ((*pairs)[0].disparity.at(3, 3), 30);
  EXPECT_EQ((*pairs)[2].disparity.at(3, 3), 30.5F);
}

}  // namespace
}  // namespace mixrig::bench
