// SPDX-License-Identifier: Apache-2.0
// Finds the master's tick that triggered a frame: by the camera's counter, always checked by time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/base/clock.h"

namespace mixrig::sync {

/// A tick of the 100 Hz master.
struct Tick {
  std::uint64_t sequence = 0;
  HostTime at{};
};

/// The last kKept ticks; missing ones are interpolated. Sequences rise; a tick that is not newer
/// than the last one means that the master restarted, and the older ones are dropped.
class TickHistory {
 public:
  explicit TickHistory(Duration nominal_period) : period_s_(seconds(nominal_period)) {}
  void add(Tick tick);
  /// Drops all ticks, since their numbers restart.
  void clear() { begin_ = count_ = 0; }

  /// Returns the fractional tick number at a time; empty if the nearest known tick is half a second
  /// away.
  std::optional<double> number_at(HostTime at) const;
  /// Returns the time of a tick, reported or interpolated; empty if the nearest known tick is half
  /// a second away.
  std::optional<HostTime> time_of(std::uint64_t sequence) const;
  bool empty() const { return count_ == 0; }
  /// Returns the number of the last tick; empty before the first.
  std::optional<std::uint64_t> newest() const {
    return count_ > 0 ? std::optional(kept(count_ - 1).sequence) : std::nullopt;
  }
  double period_s() const { return period_s_; }
  std::uint64_t lost() const { return lost_; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  static constexpr std::size_t kKept = 512;
  const Tick& kept(std::size_t i) const { return ticks_[(begin_ + i) % kKept]; }
  std::array<Tick, kKept> ticks_{};
  std::size_t begin_ = 0, count_ = 0;
  double period_s_;
  std::uint64_t lost_ = 0, restarts_ = 0;
};

/// How the master triggers a stream. With divider 0 it runs free and is only stamped.
struct StreamTiming {
  int divider = 4;   ///< ticks per frame
  int phase = 0;     ///< triggered by ticks with number mod divider == phase
  Duration delay{};  ///< from the tick to the stamp of the frame: exposure, transport
};

enum class PairStatus {
  kPaired,     ///< counter and time agree
  kLate,       ///< counter and time contradict each other: late, or a trigger was missed
  kReordered,  ///< paired by its counter; a later frame came first
  kDuplicate,  ///< the counter was seen already: drop it
  kLocking,    ///< the offset of ticks to counter is still unknown: do not use it
  kNoTick,     ///< no tick is known near its time
};
inline constexpr int kPairStatuses = 6;
std::string_view name(PairStatus status);

struct Pairing {
  PairStatus status = PairStatus::kNoTick;
  std::uint64_t tick = 0;      ///< valid for kPaired and kReordered
  Duration residual{};         ///< stamp - time of the tick - delay
  bool clock_doubted = false;  ///< paired by counter and arrival, against the stamp
  bool usable() const { return status == PairStatus::kPaired || status == PairStatus::kReordered; }
};

struct PairingCounts {
  std::array<std::uint64_t, kPairStatuses> by_status{};
  std::uint64_t missing = 0;       ///< ticks of this stream that have no frame
  std::uint64_t clock_doubts = 0;  ///< frames whose stamp contradicts counter and arrival
  std::uint64_t relocks = 0;       ///< times the offset of ticks to counter was lost
  std::uint64_t of(PairStatus status) const { return by_status[static_cast<std::size_t>(status)]; }
};

/// Pairs the frames of one stream. The offset of ticks to counter is accepted after three frames
/// in a row that agree, at the start and whenever it is lost: time shows that a camera missed or
/// doubled a trigger, and until the new offset is known its frames are kLate and kLocking, never
/// wrongly paired. The offset is lost only when stamp and arrival both contradict it: a wrong stamp
/// alone means that the camera's clock was set, a late arrival alone that the host was busy.
/// Nothing allocates. One thread.
class FramePairer {
 public:
  explicit FramePairer(StreamTiming timing) : timing_(timing) {}
  /// `sequence` is the camera's counter, `at` the frame's stamp in host time, `received` the time
  /// of its arrival.
  Pairing pair(const TickHistory& ticks, std::uint64_t sequence, HostTime at, HostTime received);
  /// Pairs a frame of a camera without a clock, by its time of arrival `at`.
  Pairing pair(const TickHistory& ticks, std::uint64_t sequence, HostTime at) {
    return pair(ticks, sequence, at, at);
  }
  /// Call it when the device was reopened: its counter restarts.
  void restart();
  const PairingCounts& counts() const { return counts_; }

 private:
  Pairing pair_free(const TickHistory& ticks, std::uint64_t sequence, HostTime at);
  Pairing pair_locked(std::uint64_t sequence, std::optional<double> by_time,
                      std::optional<double> by_arrival, double period_s);
  Pairing handle_contradiction(Pairing pairing, std::uint64_t sequence, double by_time,
                               double period_s);
  Pairing lock(std::uint64_t sequence, double by_time, double period_s);
  Pairing counted(Pairing pairing);
  bool note_counter(std::uint64_t sequence);

  StreamTiming timing_;
  PairingCounts counts_;
  bool locked_ = false;
  std::int64_t offset_ = 0;  ///< tick - divider * counter
  std::int64_t candidate_offset_ = 0;
  std::optional<double> transport_ticks_;  ///< mean time from tick to arrival, since the lock
  int agreeing_ = 0, disagreeing_ = 0, repeats_ = 0;
  bool has_counter_ = false;
  std::uint64_t newest_ = 0;  ///< largest counter so far
  std::uint64_t seen_ = 0;    ///< bit k: counter newest_ - k was seen
};

}  // namespace mixrig::sync
