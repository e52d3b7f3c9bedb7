// SPDX-License-Identifier: Apache-2.0
// Edit distance by dynamic programming over one row.
#include "host/math/config/nearest.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace mixrig::config {

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = std::exchange(row[0], static_cast<int>(i) + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int replace = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replace, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t kLongestWord = 64;  // a longer one is no misspelling
  std::optional<std::string> best;
  int best_distance = 0;
  if (word.size() > kLongestWord) return best;
  for (const std::string& candidate : known) {
    const int distance = edit_distance(word, candidate);
    if (2 * distance > static_cast<int>(candidate.size())) continue;
    if (!best || distance < best_distance) best = candidate, best_distance = distance;
  }
  return best;
}

}  // namespace mixrig::config
