// SPDX-License-Identifier: Apache-2.0
#include "hal/base/give_back.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/resident_memory.h"

namespace mixrig {
namespace {

TEST(GiveBack, an_image_is_zero_everywhere_and_can_be_written) {
  for (const Size size : {Size{1, 1}, Size{37, 5}, Size{1000, 701}}) {
    Image<float> image(size, 3);
    give_back_as_zeros(image);
    for (int y = 0; y < size.height; ++y)
      ASSERT_TRUE(
          std::all_of(image.row(y), image.row(y) + size.width, [](float f) { return f == 0; }))
          << size.width << " x " << size.height << ", row " << y;
    image.at(size.width - 1, size.height - 1) = 2;
    EXPECT_EQ(image.at(size.width - 1, size.height - 1), 2);
  }
}

TEST(GiveBack, takes_no_memory_until_it_is_written) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the sanitizer's own memory for a picture counts too";
#endif
  constexpr Size kSize{4096, 4096};  // 64 MB
  const double before_mb = test::resident_mb();
  Image<float> image(kSize, 1);
  ASSERT_GT(test::resident_mb() - before_mb, 60);
  give_back_as_zeros(image);
  EXPECT_LT(test::resident_mb() - before_mb, 4);
  for (int y = 0; y < kSize.height / 4; ++y) std::fill_n(image.row(y), kSize.width, 1.0F);
  EXPECT_GT(test::resident_mb() - before_mb, 14);
  EXPECT_LT(test::resident_mb() - before_mb, 20);
}

}  // namespace
}  // namespace mixrig
