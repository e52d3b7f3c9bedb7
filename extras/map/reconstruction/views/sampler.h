// SPDX-License-Identifier: Apache-2.0
// Draws random samples that are equal in every run. Private to this module.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace mixrig::reconstruction {

/// Draws different numbers below `count` (Knuth's 64-bit linear congruential generator).
class Sampler {
 public:
  explicit Sampler(int count) : count_(static_cast<std::uint64_t>(count)) {}

  /// Precondition: N <= count.
  template <std::size_t N>
  void draw(std::array<int, N>& sample) {
    for (std::size_t i = 0; i < N; ++i) {
      const auto end = sample.begin() + static_cast<std::ptrdiff_t>(i);
      do {
        state_ = state_ * 6364136223846793005U + 1442695040888963407U;
        sample[i] = static_cast<int>((state_ >> 33) % count_);
      } while (std::find(sample.begin(), end, sample[i]) != end);
    }
  }

 private:
  std::uint64_t count_, state_ = 0x9e3779b97f4a7c15U;
};

}  // namespace mixrig::reconstruction
