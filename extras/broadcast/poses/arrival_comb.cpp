// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/poses/arrival_comb.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mixrig::pose {
namespace {

constexpr double kLeastAgreement = 0.5;  // uniform phases of 32 packets reach 0.5 once in 3000

double wrapped(double turns) { return turns - std::round(turns); }

}  // namespace

HostTime ArrivalComb::due(HostTime received) {
  if (count_ == 0) first_ = last_due_ = received;
  phases_[count_++ % kKept] = phase_of(received);
  const std::size_t n = std::min(count_, kKept);
  double x = 0, y = 0;
  for (std::size_t i = 0; i < n; ++i) {
    x += std::cos(2 * std::numbers::pi * phases_[i]);
    y += std::sin(2 * std::numbers::pi * phases_[i]);
  }
  agreement_ = std::hypot(x, y) / static_cast<double>(n);
  center_ = std::atan2(y, x) / (2 * std::numbers::pi);
  earliest_ = 0.5;
  for (std::size_t i = 0; i < n; ++i)
    earliest_ = std::min(earliest_, wrapped(phases_[i] - center_));
  if (!fits()) return last_due_ = std::max(last_due_, received);
  const double late_s = (wrapped(phase_of(received) - center_) - earliest_) * period_s_;
  const HostTime due = received - Duration(std::llround(1e9 * late_s));
  return last_due_ = std::max(last_due_, due);
}

double ArrivalComb::phase_of(HostTime received) const {
  const double turns = seconds(received - first_) / period_s_;
  return turns - std::floor(turns);
}

Duration ArrivalComb::jitter() const {
  const std::size_t n = std::min(count_, kKept);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += std::pow(wrapped(phases_[i] - center_) - earliest_, 2);
  return Duration(n == 0 ? 0
                         : std::llround(1e9 * period_s_ * std::sqrt(sum / static_cast<double>(n))));
}

bool ArrivalComb::fits() const { return count_ < kLeast || agreement_ >= kLeastAgreement; }

}  // namespace mixrig::pose
