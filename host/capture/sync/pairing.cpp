// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/pairing.h"

#include <algorithm>
#include <cmath>

namespace mixrig::sync {
namespace {

constexpr double kFarthest_s = 0.5;
constexpr int kAgreeingFrames = 3;
constexpr std::uint64_t kWindow = 64;  // a frame may arrive this many counters late

}  // namespace

std::string_view name(PairStatus status) {
  constexpr std::array<std::string_view, kPairStatuses> kNames = {
      "paired", "late", "reordered", "duplicate", "locking", "no_tick"};
  return kNames[static_cast<std::size_t>(status)];
}

void TickHistory::add(Tick tick) {
  if (count_ > 0) {
    const Tick& last = kept(count_ - 1);
    if (tick.sequence <= last.sequence || tick.at <= last.at) {
      ++restarts_;
      begin_ = count_ = 0;
    } else {
      lost_ += tick.sequence - last.sequence - 1;
    }
  }
  if (count_ == kKept) {
    begin_ = (begin_ + 1) % kKept;
    --count_;
  }
  ticks_[(begin_ + count_) % kKept] = tick;
  ++count_;
  const Tick &first = kept(0), &last = kept(count_ - 1);
  // The master has a crystal: its period is the mean over the kept ticks, if they are enough.
  if (last.sequence - first.sequence >= 50)
    period_s_ = seconds(last.at - first.at) / static_cast<double>(last.sequence - first.sequence);
}

std::optional<double> TickHistory::number_at(HostTime at) const {
  if (count_ == 0) return std::nullopt;
  std::size_t low = 0, high = count_;  // first tick after `at` is in [low, high]
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (kept(middle).at <= at)
      low = middle + 1;
    else
      high = middle;
  }
  const Tick& before = kept(low > 0 ? low - 1 : 0);
  const Tick& after = kept(std::min(low, count_ - 1));
  const Tick& near = at - before.at <= after.at - at || low == count_ ? before : after;
  const double away_s = seconds(at - near.at);
  if (std::abs(away_s) > kFarthest_s) return std::nullopt;
  return static_cast<double>(near.sequence) + away_s / period_s_;
}

std::optional<HostTime> TickHistory::time_of(std::uint64_t sequence) const {
  if (count_ == 0) return std::nullopt;
  std::size_t low = 0, high = count_ - 1;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (kept(middle).sequence < sequence)
      low = middle + 1;
    else
      high = middle;
  }
  const Tick& near = kept(low);
  const double away_s =
      (static_cast<double>(sequence) - static_cast<double>(near.sequence)) * period_s_;
  if (std::abs(away_s) > kFarthest_s) return std::nullopt;
  return near.at + Duration(std::llround(away_s * 1e9));
}

Pairing FramePairer::pair(const TickHistory& ticks, std::uint64_t sequence, HostTime at,
                          HostTime received) {
  if (timing_.divider <= 0) return counted(pair_free(ticks, sequence, at));
  if (!note_counter(sequence)) return counted({.status = PairStatus::kDuplicate});
  const auto by_time = ticks.number_at(at - timing_.delay);
  if (locked_)
    return counted(pair_locked(sequence, by_time, ticks.number_at(received), ticks.period_s()));
  if (!by_time) return counted({.status = PairStatus::kNoTick});
  return counted(lock(sequence, *by_time, ticks.period_s()));
}

void FramePairer::restart() {
  if (locked_) ++counts_.relocks;
  locked_ = has_counter_ = false;
  agreeing_ = disagreeing_ = repeats_ = 0;
  seen_ = newest_ = 0;
}

Pairing FramePairer::pair_free(const TickHistory& ticks, std::uint64_t sequence, HostTime at) {
  if (!note_counter(sequence)) return {.status = PairStatus::kDuplicate};
  const auto number = ticks.number_at(at - timing_.delay);
  if (!number || *number < -0.5) return {.status = PairStatus::kNoTick};
  const double tick = std::round(*number);
  return {.status = sequence == newest_ ? PairStatus::kPaired : PairStatus::kReordered,
          .tick = static_cast<std::uint64_t>(tick),
          .residual = Duration(std::llround((*number - tick) * ticks.period_s() * 1e9))};
}

Pairing FramePairer::pair_locked(std::uint64_t sequence, std::optional<double> by_time,
                                 std::optional<double> by_arrival, double period_s) {
  const std::int64_t tick = offset_ + timing_.divider * static_cast<std::int64_t>(sequence);
  if (tick < 0) return {.status = PairStatus::kNoTick};
  Pairing pairing{.status = sequence == newest_ ? PairStatus::kPaired : PairStatus::kReordered,
                  .tick = static_cast<std::uint64_t>(tick)};
  const double half = 0.5 * timing_.divider;
  const auto off = [&](const std::optional<double>& by) {
    return by ? std::abs(*by - static_cast<double>(tick)) : 2 * half + 1;
  };
  const auto transport = [&] { return *by_arrival - static_cast<double>(tick); };
  if (by_time)
    pairing.residual =
        Duration(std::llround((*by_time - static_cast<double>(tick)) * period_s * 1e9));
  if (off(by_time) <= half) {
    disagreeing_ = 0;
    if (by_arrival && pairing.status == PairStatus::kPaired)
      transport_ticks_ = transport_ticks_
                             ? *transport_ticks_ + (transport() - *transport_ticks_) / 16
                             : transport();
    return pairing;
  }
  if (by_arrival && transport_ticks_ && std::abs(transport() - *transport_ticks_) <= half) {
    disagreeing_ = 0;
    ++counts_.clock_doubts;
    pairing.clock_doubted = true;
    pairing.residual = {};
    return pairing;
  }
  if (!by_time) return {.status = PairStatus::kNoTick};
  return handle_contradiction(pairing, sequence, *by_time, period_s);
}

/// Handles a frame whose counter and time disagree. A single frame may be late; if the next one
/// contradicts as well, the offset has changed.
Pairing FramePairer::handle_contradiction(Pairing pairing, std::uint64_t sequence, double by_time,
                                          double period_s) {
  if (++disagreeing_ == 1) {
    agreeing_ = 0;
    (void)lock(sequence, by_time, period_s);
    pairing.status = PairStatus::kLate;
    return pairing;
  }
  locked_ = false;
  ++counts_.relocks;
  disagreeing_ = 0;
  return lock(sequence, by_time, period_s);
}

/// Finds the offset: the nearest tick that fires this stream; three frames in a row must agree.
Pairing FramePairer::lock(std::uint64_t sequence, double by_time, double period_s) {
  const double divider = timing_.divider;
  const double tick = std::round((by_time - timing_.phase) / divider) * divider + timing_.phase;
  const auto offset =
      static_cast<std::int64_t>(tick) - timing_.divider * static_cast<std::int64_t>(sequence);
  agreeing_ = agreeing_ > 0 && offset == candidate_offset_ ? agreeing_ + 1 : 1;
  candidate_offset_ = offset;
  if (agreeing_ < kAgreeingFrames || tick < 0) return {.status = PairStatus::kLocking};
  locked_ = true;
  offset_ = offset;
  transport_ticks_.reset();
  agreeing_ = disagreeing_ = 0;
  return {.status = PairStatus::kPaired,
          .tick = static_cast<std::uint64_t>(tick),
          .residual = Duration(std::llround((by_time - tick) * period_s * 1e9))};
}

/// Notes a counter; false if it was seen already. A counter far behind, or repeated counters of
/// several frames, are not late frames: the camera has restarted its counter.
bool FramePairer::note_counter(std::uint64_t sequence) {
  const bool known = has_counter_ && sequence <= newest_ && newest_ - sequence < kWindow &&
                     (seen_ & 1ULL << (newest_ - sequence)) != 0;
  repeats_ = known ? repeats_ + 1 : 0;
  if (has_counter_ && (sequence + kWindow <= newest_ || repeats_ >= kAgreeingFrames))
    restart();
  else if (known)
    return false;
  if (!has_counter_ || sequence > newest_) {
    const std::uint64_t step = has_counter_ ? sequence - newest_ : kWindow;
    if (has_counter_) counts_.missing += step - 1;
    seen_ = step < kWindow ? (seen_ << step) | 1 : 1;
    newest_ = sequence;
    has_counter_ = true;
    return true;
  }
  seen_ |= 1ULL << (newest_ - sequence);
  if (counts_.missing > 0) --counts_.missing;
  return true;
}

Pairing FramePairer::counted(Pairing pairing) {
  ++counts_.by_status[static_cast<std::size_t>(pairing.status)];
  return pairing;
}

}  // namespace mixrig::sync
