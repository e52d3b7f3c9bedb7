// SPDX-License-Identifier: Apache-2.0
#include "hal/base/quantile_sketch.h"

#include <algorithm>
#include <cmath>

namespace mixrig::measure {
namespace {

constexpr double kAlpha = QuantileSketch::kRelativeError;

/// Logarithm of the ratio of neighbouring bounds, gamma = (1 + alpha) / (1 - alpha).
double log_gamma() {
  static const double value = std::log1p(kAlpha) - std::log1p(-kAlpha);
  return value;
}

/// Bucket i covers kSmallest * (gamma^(i-1), gamma^i].
std::size_t index_of(double sample) {
  return static_cast<std::size_t>(
      std::ceil(std::log(sample / QuantileSketch::kSmallest) / log_gamma()));
}

/// The value that is wrong by the same factor at both ends of the bucket: 2 gamma^i / (gamma + 1).
double middle_of(std::size_t index) {
  return QuantileSketch::kSmallest * std::exp(static_cast<double>(index) * log_gamma()) *
         (1.0 - kAlpha);
}

// The first bucket holds zeros and samples below kSmallest, the last samples above kLargest.
constexpr std::size_t kZero = 0;
constexpr std::size_t kFirst = 1;

std::size_t bucket_count() { return kFirst + index_of(QuantileSketch::kLargest) + 2; }

}  // namespace

QuantileSketch::QuantileSketch() : buckets_(bucket_count(), 0) {}

bool QuantileSketch::add(double sample) {
  if (!std::isfinite(sample) || sample < 0.0) {
    ++refused_;
    return false;
  }
  std::size_t bucket = kZero;
  if (sample > kLargest) {
    bucket = buckets_.size() - 1;
  } else if (sample >= kSmallest) {
    bucket = kFirst + index_of(sample);
  }
  ++buckets_[bucket];
  min_ = count_ == 0 ? sample : std::min(min_, sample);
  max_ = count_ == 0 ? sample : std::max(max_, sample);
  sum_ += sample;
  ++count_;
  return true;
}

QuantileSketch::Position QuantileSketch::find_rank(std::uint64_t rank, Position at) const {
  while (at.count_to_end <= rank) at.count_to_end += buckets_[++at.bucket];
  return at;
}

double QuantileSketch::value_at(std::uint64_t rank, std::size_t bucket) const {
  if (rank == 0) return min_;
  if (rank == count_ - 1 || bucket == buckets_.size() - 1) return max_;
  if (bucket == kZero) return min_;
  return std::clamp(middle_of(bucket - kFirst), min_, max_);
}

double QuantileSketch::quantile(double q) const {
  if (count_ == 0) return 0.0;
  const double rank = std::clamp(q, 0.0, 1.0) * static_cast<double>(count_ - 1);
  const double part = rank - std::floor(rank);
  const auto below = static_cast<std::uint64_t>(std::floor(rank));
  const Position low = find_rank(below, {kZero, buckets_[kZero]});
  const double low_value = value_at(below, low.bucket);
  if (part == 0.0) return low_value;
  const Position high = find_rank(below + 1, low);
  return low_value + part * (value_at(below + 1, high.bucket) - low_value);
}

double QuantileSketch::mean() const {
  return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_);
}

}  // namespace mixrig::measure
