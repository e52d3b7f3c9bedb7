// SPDX-License-Identifier: Apache-2.0
#include "hal/base/percentile.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mixrig::measure {

double quantile(std::vector<float> samples, double q) {
  if (samples.empty()) return 0.0;
  const double rank = std::clamp(q, 0.0, 1.0) * static_cast<double>(samples.size() - 1);
  const auto below = samples.begin() + static_cast<std::ptrdiff_t>(std::floor(rank));
  std::nth_element(samples.begin(), below, samples.end());
  const double low = *below;
  const double part = rank - std::floor(rank);
  if (part == 0.0) return low;
  return low + part * (*std::min_element(below + 1, samples.end()) - low);
}

double mean(std::span<const float> samples) {
  if (samples.empty()) return 0.0;
  return std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
}

}  // namespace mixrig::measure
