// SPDX-License-Identifier: Apache-2.0
#include "host/output/sheet/contact_sheet.h"

#include <gtest/gtest.h>

namespace mixrig::output {
namespace {

TEST(Spread, TakesTheMiddleOfEqualParts) {
  EXPECT_EQ(spread(1, 100, 4), (std::vector<int>{13, 38, 63, 88}));
  EXPECT_EQ(spread(5, 7, 6), (std::vector<int>{5, 6, 7}));
  EXPECT_EQ(spread(9, 9, 3), (std::vector<int>{9}));
}

}  // namespace
}  // namespace mixrig::output
