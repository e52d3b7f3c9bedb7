// SPDX-License-Identifier: Apache-2.0
#include "hal/base/recent_log.h"

#include <gtest/gtest.h>

#include "hal/base/log.h"

namespace mixrig {
namespace {

TEST(RecentLog, KeepsTheNewestLinesThatWereWritten) {
  log_info("base", "below the level");
  for (int i = 0; i < 60; ++i) log_warning("base", "line " + std::to_string(i));
  const auto lines = recent_log_lines();
  ASSERT_EQ(lines.size(), 50U);
  EXPECT_EQ(lines.front(), "warning base: line 10");
  EXPECT_EQ(lines.back(), "warning base: line 59");
}

}  // namespace
}  // namespace mixrig
