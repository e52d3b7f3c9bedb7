// SPDX-License-Identifier: Apache-2.0
// Master ticks by the edges of one trigger line that the host's own kernel stamps: a second opinion
// about the master's word, and ticks where it says nothing.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/clock.h"
#include "host/sync/pairing.h"

namespace mixrig::sync {

/// Which ticks fire the line.
struct EdgeLine {
  int divider = 1, phase = 0;  ///< tick numbers that are phase mod divider
  Duration rest{};             ///< from tick to edge, less than one period
};

struct EdgeCounts {
  std::uint64_t edges = 0;
  std::uint64_t lost = 0;     ///< pulses that were not seen, by the time between two edges
  std::uint64_t doubled = 0;  ///< edges of a pulse that had one: the line rings
  std::uint64_t filled = 0;   ///< ticks made of edges
  /// Edge less the master's word, from two seconds after its start on: its clock is known then.
  double offset_mean_ms = 0, offset_sd_ms = 0, offset_max_ms = 0;
};

/// Nothing allocates. One thread.
class EdgeTicks {
 public:
  /// `master`: somebody tells ticks. Without one the first edge is tick `phase`, and so is the
  /// first after a second without edges: whoever fires the line has begun anew.
  EdgeTicks(EdgeLine line, Duration nominal_period, bool master)
      : line_(line), master_(master), told_(nominal_period) {}

  /// A tick as the master tells it.
  void told(Tick tick) {
    told_.add(tick);
    ++told_count_;
  }
  struct Made {
    Tick tick;
    bool restarted = false;  ///< numbers begin anew with it
  };
  /// An edge. A tick where the master tells none: there is none, or it has been silent for a
  /// quarter of a second and numbers are known from before.
  std::optional<Made> add(HostTime at);
  /// The master was started anew.
  void restart();
  EdgeCounts counts() const;

 private:
  std::optional<double> told_number(HostTime tick_at) const;
  std::uint64_t nearest(double number) const;
  void count(std::uint64_t tick);
  void judge(double number, std::uint64_t tick);

  EdgeLine line_;
  bool master_;
  TickHistory told_;
  std::optional<Tick> last_;  ///< of the last edge
  EdgeCounts counts_;
  std::uint64_t judged_ = 0, told_count_ = 0;
  double offset_sum_s_ = 0, offset_square_s2_ = 0, offset_max_s_ = 0;
};

}  // namespace mixrig::sync
