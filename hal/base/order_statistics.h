// SPDX-License-Identifier: Apache-2.0
// Medians and order statistics in linear time. Values must not be NaN.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

namespace mixrig {

/// The value at index `rank` of the sorted values. Reorders them: those before `rank` are not
/// greater, those after it not smaller. Precondition: rank < values.size().
template <typename T>
T order_statistic(std::span<T> values, std::size_t rank) {
  assert(rank < values.size());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Returns the middle value, for an even count the upper of the two middle ones; 0 for no values.
/// It is always one of the values. Reorders them.
template <typename T>
T upper_median_in_place(std::span<T> values) {
  return values.empty() ? T{} : order_statistic(values, values.size() / 2);
}

/// upper_median_in_place() on a copy of the values.
template <typename T>
T upper_median(std::vector<T> values) {
  return upper_median_in_place(std::span<T>(values));
}

/// Returns the middle value, for an even count the mean of the two middle ones; 0 for no values.
/// Reorders them.
template <typename T>
T median_in_place(std::span<T> values) {
  const T upper = upper_median_in_place(values);
  if (values.size() % 2 == 1 || values.empty()) return upper;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  return T(0.5) * (upper + *std::max_element(values.begin(), middle));
}

}  // namespace mixrig
