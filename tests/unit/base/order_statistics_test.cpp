// SPDX-License-Identifier: Apache-2.0
#include "hal/base/order_statistics.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

TEST(OrderStatistic, IsTheValueThatSortingPutsThere) {
  std::mt19937 random(1);
  for (std::size_t count = 1; count < 40; ++count) {
    std::vector<int> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<int>(random() % 20));
    std::vector<int> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t rank = 0; rank < count; ++rank)
      ASSERT_EQ(order_statistic(std::span(values), rank), sorted[rank]);
    ASSERT_TRUE(std::is_permutation(values.begin(), values.end(), sorted.begin(), sorted.end()));
  }
}

TEST(OrderStatistic, PartsTheValues) {
  std::vector<int> values{5, 1, 4, 2, 3};
  EXPECT_EQ(order_statistic(std::span(values), 3), 4);
  EXPECT_EQ(values[3], 4);
  EXPECT_EQ(values[4], 5);
}

TEST(UpperMedian, IsTheUpperMiddleValueOfAnEvenCount) {
  EXPECT_EQ(upper_median(std::vector{3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(upper_median(std::vector{4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(upper_median(std::vector{2.0, 1.0}), 2.0);
  EXPECT_EQ(upper_median(std::vector{7.0F}), 7.0F);
  EXPECT_EQ(upper_median(std::vector<double>{}), 0.0);
}

TEST(UpperMedian, LeavesACopiedVectorAsItIs) {
  const std::vector<double> values{4, 1, 3, 2};
  EXPECT_EQ(upper_median(values), 3.0);
  EXPECT_EQ(values, (std::vector<double>{4, 1, 3, 2}));
}

TEST(Median, IsTheMeanOfBothMiddleValuesOfAnEvenCount) {
  std::vector<float> values{4, 1, 3, 2};
  EXPECT_EQ(median_in_place(std::span(values)), 2.5F);
  values = {9, 1, 3};
  EXPECT_EQ(median_in_place(std::span(values)), 3.0F);
  values = {2, 1};
  EXPECT_EQ(median_in_place(std::span(values)), 1.5F);
  values = {};
  EXPECT_EQ(median_in_place(std::span(values)), 0.0F);
}

}  // namespace
}  // namespace mixrig
