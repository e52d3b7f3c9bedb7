// SPDX-License-Identifier: Apache-2.0
// Maps the trigger controller's clock to host time, from round trips.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/base/clock.h"

namespace mixrig::sync {

/// A map from controller time to host time. In every round trip the controller read its clock after
/// the request was sent and before the answer was received: two bounds of the offset. Lines
/// (offset, drift) that satisfy all bounds form a convex polygon; the estimate is its centroid.
/// Only the shortest delays of each direction limit the polygon; longer ones do not change it, so
/// the estimate is robust without weights. Each second keeps its two tightest bounds, for kSpans
/// seconds. The bounds hold for any delays; the centroid assumes that the shortest delays of both
/// directions are equal. Nothing allocates. One thread.
class ClockMap {
 public:
  enum class Verdict {
    kOk,
    kRestarted,  ///< no line fits any more: all earlier samples were dropped
  };
  /// Adds a round trip: the controller read `mcu`, in whole microseconds, between `sent` and
  /// `received`.
  Verdict add(McuTime mcu, HostTime sent, HostTime received);

  /// Returns the host time; empty before the first sample.
  std::optional<HostTime> to_host(McuTime mcu) const;
  /// Largest possible error of to_host(mcu), if the drift is constant over the window.
  std::optional<Duration> bound(McuTime mcu) const;
  /// (host rate / controller rate - 1) * 1e6.
  double drift_ppm() const { return line_.slope * 1e6; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  /// Host minus controller time, seconds, at `at_s` of the controller.
  struct Line {
    double offset_s = 0, slope = 0;
    double at(double at_s) const { return offset_s + slope * at_s; }
  };
  struct Trip {
    double at_s = 0;               ///< controller time since the first sample
    double low_s = 0, high_s = 0;  ///< host minus controller time lies between these
  };
  /// The tightest bounds of one second: greatest lower bound, least upper bound.
  struct Span {
    double begin_s = 0;
    Trip low, high;
  };
  static constexpr int kSpans = 256;
  static constexpr double kSpan_s = 1;
  static constexpr int kCorners = 64;

  void reset(McuTime mcu, HostTime sent);
  void keep(const Trip& trip);
  bool fit();
  bool fit_bounds();
  void clip(double at_s, double limit_s, double sign);
  Line centroid() const;
  const Span& span(int i) const { return spans_[(first_ + i) % kSpans]; }
  double since_first_s(McuTime mcu) const { return seconds(mcu - first_mcu_); }

  std::array<Span, kSpans> spans_{};
  int first_ = 0, count_ = 0;
  /// Corners of the polygon: slopes, and offsets at pivot_s_.
  std::array<Line, kCorners> corners_{};
  int corner_count_ = 0;
  double pivot_s_ = 0;  ///< middle of the window: offsets in corners_ and line_ are taken there
  McuTime first_mcu_{}, last_mcu_{};
  HostTime first_host_{};
  Line line_;
  std::uint64_t restarts_ = 0;
};

}  // namespace mixrig::sync
