// SPDX-License-Identifier: Apache-2.0
// Quantiles of a stream of any length in constant memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mixrig::measure {

/// Counts of samples in buckets whose bounds grow by a constant factor (DDSketch: Masson, Rim and
/// Lee 2019, section 2), so that every quantile has a bounded relative error.
/// Samples are finite and not negative, in any unit. All memory (about 140 kB) is allocated by the
/// constructor. Not thread-safe.
class QuantileSketch {
 public:
  /// Bound of the relative error of a quantile for samples in [kSmallest, kLargest].
  static constexpr double kRelativeError = 1e-3;
  /// Zeros and samples below this share one bucket; a quantile that falls there is min().
  static constexpr double kSmallest = 1e-6;
  /// Samples above this share one bucket; a quantile that falls there is max().
  static constexpr double kLargest = 1e9;

  QuantileSketch();

  /// Adds one sample in constant time. False, and nothing but refused() changes, if it is negative,
  /// infinite or NaN.
  bool add(double sample);

  /// The q-quantile (q in 0..1, clamped) by the rank rule of measure::quantile (linear
  /// interpolation between the two nearest ranks; Hyndman and Fan 1996, type 7). Exact at q = 0 and
  /// q = 1, within kRelativeError between. 0 without samples.
  [[nodiscard]] double quantile(double q) const;

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// How many calls of add() returned false.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  /// Arithmetic mean, from the sum of the samples in the order of add(); 0 without samples.
  [[nodiscard]] double mean() const;
  /// Smallest sample, exact; 0 without samples.
  [[nodiscard]] double min() const { return min_; }
  /// Largest sample, exact; 0 without samples.
  [[nodiscard]] double max() const { return max_; }

 private:
  /// A bucket, and the number of samples in it and in all lower buckets.
  struct Position {
    std::size_t bucket = 0;
    std::uint64_t count_to_end = 0;
  };
  [[nodiscard]] Position find_rank(std::uint64_t rank, Position at) const;
  [[nodiscard]] double value_at(std::uint64_t rank, std::size_t bucket) const;

  std::vector<std::uint64_t> buckets_;  // zeros, kSmallest ... kLargest, above kLargest
  std::uint64_t count_ = 0;
  std::uint64_t refused_ = 0;
  double sum_ = 0;
  double min_ = 0;
  double max_ = 0;
};

}  // namespace mixrig::measure
