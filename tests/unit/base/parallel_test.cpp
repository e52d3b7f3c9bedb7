// SPDX-License-Identifier: Apache-2.0
#include "hal/base/parallel.h"

#include <atomic>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

class CrewTest : public ::testing::TestWithParam<int> {};

TEST_P(CrewTest, CoversEveryRowOnce) {
  Crew crew(GetParam());
  for (const int count : {0, 1, 7, 64, 1000}) {
    std::vector<std::atomic<int>> hits(static_cast<std::size_t>(count));
    crew.rows(count, 8, [&](int begin, int end) {
      EXPECT_LE(end - begin, 8);
      for (int i = begin; i < end; ++i) ++hits[static_cast<std::size_t>(i)];
    });
    for (const auto& h : hits) EXPECT_EQ(h, 1);
  }
}

TEST_P(CrewTest, ManyCallsInARowAllReturn) {
  Crew crew(GetParam());
  std::atomic<int> sum = 0;
  for (int i = 0; i < 2000; ++i) crew.rows(4, 1, [&](int begin, int end) { sum += end - begin; });
  EXPECT_EQ(sum, 8000);
}

INSTANTIATE_TEST_SUITE_P(Threads, CrewTest, ::testing::Values(1, 2, 5));

TEST(Crew, ZeroMeansOnePerCore) { EXPECT_GE(Crew(0).threads(), 1); }

}  // namespace
}  // namespace mixrig
