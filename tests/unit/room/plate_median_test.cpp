// SPDX-License-Identifier: Apache-2.0
#include "host/room/background/plate_median.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig::model {
namespace {

Image<Rgb8> noise_plate(Size size, unsigned seed) {
  std::mt19937 random(seed);
  Image<Rgb8> plate(size);
  const auto byte = [&] { return static_cast<std::uint8_t>(random() >> 24); };
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) plate.at(x, y) = {byte(), byte(), byte()};
  return plate;
}

/// Median by sorting; for an even count the mean of the two middle values, rounded up.
std::uint8_t middle_of(std::vector<std::uint8_t> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return static_cast<std::uint8_t>((values[(n - 1) / 2] + values[n / 2] + 1) / 2);
}

TEST(PlateMedian, IsThatOfEachPixelAndChannel) {
  Crew crew(2);
  PlateMedian median;
  constexpr Size kSize{33, 20};
  for (unsigned frames = 3; frames <= PlateMedian::kMostPlates; ++frames) {
    std::vector<Image<Rgb8>> plates;
    median.clear();
    for (unsigned i = 0; i < frames; ++i) {
      plates.push_back(noise_plate(kSize, 10 * frames + i));
      median.add(plates.back().view());
    }
    Image<Rgb8> found;
    median.finish(found, crew);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        std::vector<std::uint8_t> r, b;
        for (const auto& plate : plates)
          r.push_back(plate.at(x, y).r), b.push_back(plate.at(x, y).b);
        ASSERT_EQ(found.at(x, y).r, middle_of(r)) << frames;
        ASSERT_EQ(found.at(x, y).b, middle_of(b)) << frames;
      }
  }
}

TEST(PlateMedian, OfOneOrTwoIsTheFirstAndOfNoneEmpty) {
  Crew crew(1);
  PlateMedian median;
  Image<Rgb8> found;
  median.add(noise_plate({5, 4}, 1).view());
  median.add(noise_plate({5, 4}, 2).view());
  median.finish(found, crew);
  EXPECT_EQ(found.at(3, 2), noise_plate({5, 4}, 1).at(3, 2));
  median.clear();
  median.finish(found, crew);
  EXPECT_TRUE(found.empty());
}

TEST(PlateMedian, LeavesOutFramesBeyondItsMemory) {
  Crew crew(1);
  PlateMedian median;
  for (std::size_t i = 0; i < 3 * PlateMedian::kMostPlates; ++i)
    median.add(Image<Rgb8>({4, 3}, i < PlateMedian::kMostPlates ? Rgb8{9, 9, 9} : Rgb8{}).view());
  Image<Rgb8> found;
  median.finish(found, crew);
  EXPECT_EQ(found.at(0, 0), (Rgb8{9, 9, 9}));
}

}  // namespace
}  // namespace mixrig::model
