// SPDX-License-Identifier: Apache-2.0
#include "host/math/config/nearest.h"

#include <gtest/gtest.h>

namespace mixrig::config {
namespace {

TEST(EditDistance, TextbookValues) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("flaw", "lawn"), 2);
  EXPECT_EQ(edit_distance("sunday", "saturday"), 3);
}

TEST(Nearest, FindsTheWordThatWasMeantAndNothingForNonsense) {
  const std::vector<std::string> known{"threshold_m", "noise_factor", "color"};
  EXPECT_EQ(nearest("treshold_m", known), "threshold_m");
  EXPECT_EQ(nearest("colour", known), "color");
  EXPECT_EQ(nearest("zzzzzzzz", known), std::nullopt);
  EXPECT_EQ(nearest(std::string(100000, 'c'), known), std::nullopt);
}

}  // namespace
}  // namespace mixrig::config
