// SPDX-License-Identifier: Apache-2.0
#include "hal/base/image.h"

#include <gtest/gtest.h>

namespace mixrig {
namespace {

TEST(Image, RowsAreAlignedAndFilled) {
  Image<float> image({5, 3}, 2.5F);
  for (int y = 0; y < 3; ++y) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(image.row(y)) % 64, 0U);
    for (int x = 0; x < 5; ++x) EXPECT_EQ(image.at(x, y), 2.5F);
  }
}

TEST(Image, PixelsOfThreeBytesArePacked) {
  const Image<Rgb8> image({7, 2});
  EXPECT_EQ(image.stride(), 7);
}

TEST(Image, CopyIsDeep) {
  Image<int> a({4, 4}, 1);
  Image<int> b = a;
  b.at(2, 3) = 9;
  EXPECT_EQ(a.at(2, 3), 1);
  EXPECT_EQ(b.at(2, 3), 9);
  a = b;
  EXPECT_EQ(a.at(2, 3), 9);
}

TEST(Image, ResetKeepsMemoryOfTheSameSize) {
  Image<int> a({4, 4}, 1);
  const int* before = a.row(0);
  a.reset({4, 4}, 3);
  EXPECT_EQ(a.row(0), before);
  EXPECT_EQ(a.at(0, 0), 3);
  a.reset({2, 1}, 5);
  EXPECT_EQ(a.size(), (Size{2, 1}));
}

TEST(Image, MovedFromIsEmpty) {
  Image<int> a({4, 4}, 1);
  const Image<int> b = std::move(a);
  EXPECT_TRUE(a.empty());  // NOLINT(bugprone-use-after-move): that is what is tested
  EXPECT_EQ(b.at(3, 3), 1);
}

TEST(Image, EmptyImageCanBeFilledAndCopied) {
  Image<int> a;
  a.fill(1);
  const Image<int> b = a;
  EXPECT_TRUE(b.view().empty());
}

}  // namespace
}  // namespace mixrig
