// SPDX-License-Identifier: Apache-2.0
#include "extras/people/plan/assignment.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::plan {
namespace {

/// Fewest rows without a column, then the least sum, by all orders of the columns.
std::pair<int, double> best_of_all(const Eigen::MatrixXd& cost) {
  std::vector<int> order(static_cast<std::size_t>(cost.cols() + cost.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::pair<int, double> best{1000, 0};
  do {
    std::pair<int, double> now{0, 0};
    for (Eigen::Index r = 0; r < cost.rows(); ++r) {
      const int c = order[static_cast<std::size_t>(r)];
      if (c < cost.cols() && cost(r, c) < kForbidden)
        now.second += cost(r, c);
      else
        ++now.first;
    }
    best = std::min(best, now);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(Assignment, is_as_good_as_the_best_of_all_orders) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(0, 20);
  for (int trial = 0; trial < 60; ++trial) {
    Eigen::MatrixXd cost(1 + trial % 3, 1 + trial % 4);
    for (Eigen::Index i = 0; i < cost.size(); ++i)
      cost(i) = value(random) < 6 ? kForbidden : value(random);
    const std::vector<int> column_of = assign(cost);
    std::pair<int, double> got{0, 0};
    std::vector<int> used;
    for (Eigen::Index r = 0; r < cost.rows(); ++r) {
      const int c = column_of[static_cast<std::size_t>(r)];
      if (c < 0) {
        ++got.first;
        continue;
      }
      ASSERT_LT(cost(r, c), kForbidden);
      EXPECT_EQ(std::count(used.begin(), used.end(), c), 0);
      used.push_back(c);
      got.second += cost(r, c);
    }
    const auto best = best_of_all(cost);
    EXPECT_EQ(got.first, best.first) << cost;
    EXPECT_NEAR(got.second, best.second, 1e-9) << cost;
  }
}

TEST(Assignment, of_nothing_is_nothing) {
  EXPECT_TRUE(assign(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(assign(Eigen::MatrixXd(2, 0)), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace mixrig::plan
