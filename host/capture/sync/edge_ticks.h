// SPDX-License-Identifier: Apache-2.0
// Master ticks from the edges of one trigger line, stamped by the host's kernel: a check of the
// ticks that the master reports, and a replacement while it reports none.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/clock.h"
#include "host/capture/sync/pairing.h"

namespace mixrig::sync {

/// The ticks that fire the line.
struct EdgeLine {
  int divider = 1, phase = 0;  ///< ticks with number mod divider == phase
  Duration rest{};             ///< from tick to edge, less than one period
};

struct EdgeCounts {
  std::uint64_t edges = 0;
  std::uint64_t lost = 0;     ///< pulses without an edge, computed from the time between two edges
  std::uint64_t doubled = 0;  ///< further edges of one pulse: the line rings
  std::uint64_t filled = 0;   ///< ticks made from edges
  /// Edge minus reported tick, counted from two seconds after the start, when the clock map is
  /// accurate.
  double offset_mean_ms = 0, offset_sd_ms = 0, offset_max_ms = 0;
};

/// Turns edges into ticks. Nothing allocates. For one thread.
class EdgeTicks {
 public:
  /// `master`: a master reports ticks. Without a master the first edge is tick `phase`, as is the
  /// first after a second without edges: the device that fires the line has restarted.
  EdgeTicks(EdgeLine line, Duration nominal_period, bool master)
      : line_(line), master_(master), master_ticks_(nominal_period) {}

  /// Takes a tick that the master reports.
  void on_master_tick(Tick tick) {
    master_ticks_.add(tick);
    ++master_tick_count_;
  }
  struct Made {
    Tick tick;
    bool restarted = false;  ///< tick numbers restart with this tick
  };
  /// Takes an edge. Returns a tick if the master reports none: there is no master, or it has
  /// reported nothing for a quarter of a second and earlier tick numbers are known.
  std::optional<Made> add(HostTime at);
  /// Call it when the master was restarted.
  void restart();
  EdgeCounts counts() const;

 private:
  std::optional<double> master_number(HostTime tick_at) const;
  std::uint64_t nearest(double number) const;
  void count(std::uint64_t tick);
  void judge(double number, std::uint64_t tick);

  EdgeLine line_;
  bool master_;
  TickHistory master_ticks_;
  std::optional<Tick> last_;  ///< tick of the last edge
  EdgeCounts counts_;
  std::uint64_t judged_ = 0, master_tick_count_ = 0;
  double offset_sum_s_ = 0, offset_square_s2_ = 0, offset_max_s_ = 0;
};

}  // namespace mixrig::sync
