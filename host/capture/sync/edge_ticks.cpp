// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/edge_ticks.h"

#include <algorithm>
#include <cmath>

namespace mixrig::sync {
namespace {

constexpr Duration kSilence = std::chrono::milliseconds(250);
constexpr std::uint64_t kTrusted_ticks = 200;
constexpr Duration kRestartGap = std::chrono::seconds(1);

}  // namespace

std::optional<EdgeTicks::Made> EdgeTicks::add(HostTime at) {
  ++counts_.edges;
  const HostTime tick_at = at - line_.rest;
  if (const auto number = master_number(tick_at)) {
    const std::uint64_t tick = nearest(*number);
    count(tick);
    judge(*number, tick);
    last_ = Tick{tick, tick_at};
    return std::nullopt;
  }
  const bool restarts = !last_ || (!master_ && tick_at - last_->at > kRestartGap);
  if (restarts && master_) return std::nullopt;  // edges alone do not determine its numbers
  Tick tick{static_cast<std::uint64_t>(line_.phase), tick_at};
  if (!restarts) {
    tick.sequence = nearest(static_cast<double>(last_->sequence) +
                            seconds(tick_at - last_->at) / master_ticks_.period_s());
    count(tick.sequence);
    if (tick.sequence <= last_->sequence) return std::nullopt;
  }
  const bool restarted = restarts && last_;
  last_ = tick;
  ++counts_.filled;
  return Made{tick, restarted};
}

/// Returns the tick number by the master's reported ticks, if the newest one is not older than
/// kSilence.
std::optional<double> EdgeTicks::master_number(HostTime tick_at) const {
  const auto newest = master_ticks_.newest();
  if (!newest) return std::nullopt;
  const auto newest_at = master_ticks_.time_of(*newest);
  if (!newest_at || tick_at - *newest_at > kSilence) return std::nullopt;
  return master_ticks_.number_at(tick_at);
}

/// Returns the nearest of the ticks that fire the line.
std::uint64_t EdgeTicks::nearest(double number) const {
  const double tick =
      std::round((number - line_.phase) / line_.divider) * line_.divider + line_.phase;
  return static_cast<std::uint64_t>(std::max<double>(tick, line_.phase));
}

void EdgeTicks::count(std::uint64_t tick) {
  if (!last_) return;
  if (tick <= last_->sequence) {
    ++counts_.doubled;
    return;
  }
  counts_.lost += (tick - last_->sequence) / static_cast<std::uint64_t>(line_.divider) - 1;
}

void EdgeTicks::judge(double number, std::uint64_t tick) {
  if (master_tick_count_ < kTrusted_ticks) return;
  const double off_s = (number - static_cast<double>(tick)) * master_ticks_.period_s();
  ++judged_;
  offset_sum_s_ += off_s;
  offset_square_s2_ += off_s * off_s;
  if (std::abs(off_s) > std::abs(offset_max_s_)) offset_max_s_ = off_s;
}

void EdgeTicks::restart() {
  master_ticks_ =
      TickHistory(std::chrono::nanoseconds(std::llround(master_ticks_.period_s() * 1e9)));
  master_tick_count_ = 0;
  last_.reset();
}

EdgeCounts EdgeTicks::counts() const {
  EdgeCounts counts = counts_;
  if (judged_ == 0) return counts;
  const double n = static_cast<double>(judged_), mean_s = offset_sum_s_ / n;
  counts.offset_mean_ms = mean_s * 1e3;
  counts.offset_sd_ms = 1e3 * std::sqrt(std::max(0.0, offset_square_s2_ / n - mean_s * mean_s));
  counts.offset_max_ms = offset_max_s_ * 1e3;
  return counts;
}

}  // namespace mixrig::sync
