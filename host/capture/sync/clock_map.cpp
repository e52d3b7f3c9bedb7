// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/clock_map.h"

#include <algorithm>
#include <cmath>

namespace mixrig::sync {

namespace {

constexpr double kResolution_s = 1e-6;  // the controller reports whole microseconds
constexpr double kSlopeMax = 5e-3;      // above the error of any crystal or trimmed RC oscillator

}  // namespace

void ClockMap::reset(McuTime mcu, HostTime sent) {
  count_ = first_ = 0;
  line_ = {};
  first_mcu_ = mcu;
  first_host_ = sent;
}

ClockMap::Verdict ClockMap::add(McuTime mcu, HostTime sent, HostTime received) {
  Verdict verdict = Verdict::kOk;
  if (count_ == 0 || mcu < last_mcu_) {
    if (count_ != 0) {
      ++restarts_;
      verdict = Verdict::kRestarted;
    }
    reset(mcu, sent);
  }
  last_mcu_ = mcu;
  const double at_s = since_first_s(mcu);
  keep({at_s, seconds(sent - first_host_) - at_s - kResolution_s,
        seconds(received - first_host_) - at_s});
  // The drift of a crystal changes: the oldest bounds become wrong first.
  while (!fit() && count_ > 1) {
    const int dropped = (count_ + 1) / 2;
    first_ = (first_ + dropped) % kSpans;
    count_ -= dropped;
    if (count_ == 1) {
      ++restarts_;
      verdict = Verdict::kRestarted;
    }
  }
  if (corner_count_ > 0) return verdict;
  // No line fits even one second of bounds: the clock has just jumped.
  if (verdict == Verdict::kOk) ++restarts_;
  reset(mcu, sent);
  keep({0, -kResolution_s, seconds(received - sent)});
  fit();
  return Verdict::kRestarted;
}

void ClockMap::keep(const Trip& trip) {
  if (count_ == 0 || trip.at_s >= span(count_ - 1).begin_s + kSpan_s) {
    if (count_ == kSpans) {
      first_ = (first_ + 1) % kSpans;
      --count_;
    }
    spans_[(first_ + count_++) % kSpans] = {trip.at_s, trip, trip};
    return;
  }
  Span& last = spans_[(first_ + count_ - 1) % kSpans];
  // Bounds of different times are compared after the present estimate of the drift is removed.
  const auto level = [&](const Trip& t, double value_s) { return value_s - line_.slope * t.at_s; };
  if (level(trip, trip.low_s) > level(last.low, last.low.low_s)) last.low = trip;
  if (level(trip, trip.high_s) < level(last.high, last.high.high_s)) last.high = trip;
}

bool ClockMap::fit() {
  pivot_s_ = 0.5 * (span(0).begin_s + span(count_ - 1).begin_s);
  if (!fit_bounds()) return false;
  line_ = centroid();
  return true;
}

/// Makes the polygon of all lines within the bounds; false if there is none.
bool ClockMap::fit_bounds() {
  double low_s = span(0).low.low_s, high_s = span(0).high.high_s, reach_s = 1;
  for (int i = 0; i < count_; ++i) {
    low_s = std::min(low_s, span(i).low.low_s);
    high_s = std::max(high_s, span(i).high.high_s);
    reach_s = std::max(reach_s, std::abs(span(i).begin_s - pivot_s_) + kSpan_s);
  }
  low_s -= kSlopeMax * reach_s;
  high_s += kSlopeMax * reach_s;
  corners_[0] = {low_s, -kSlopeMax};
  corners_[1] = {high_s, -kSlopeMax};
  corners_[2] = {high_s, kSlopeMax};
  corners_[3] = {low_s, kSlopeMax};
  corner_count_ = 4;
  for (int i = 0; i < count_ && corner_count_ > 0; ++i) {
    clip(span(i).low.at_s, span(i).low.low_s, 1);
    clip(span(i).high.at_s, span(i).high.high_s, -1);
  }
  return corner_count_ > 0;
}

/// Keeps the part of the polygon where sign * (line(at_s) - limit_s) >= 0 (Sutherland-Hodgman).
void ClockMap::clip(double at_s, double limit_s, double sign) {
  std::array<Line, kCorners + 1> kept;
  int n = 0;
  const auto inside = [&](const Line& line) { return sign * (line.at(at_s - pivot_s_) - limit_s); };
  for (int i = 0; i < corner_count_; ++i) {
    const Line& here = corners_[i];
    const Line& next = corners_[(i + 1) % corner_count_];
    const double a = inside(here), b = inside(next);
    if (a >= 0) kept[n++] = here;
    if ((a >= 0) != (b >= 0)) {
      const double t = a / (a - b);
      kept[n++] = {here.offset_s + t * (next.offset_s - here.offset_s),
                   here.slope + t * (next.slope - here.slope)};
    }
    // Too many corners: skip this bound; the polygon stays valid, only larger.
    if (n > kCorners - 2) return;
  }
  std::copy_n(kept.begin(), n, corners_.begin());
  corner_count_ = n;
}

ClockMap::Line ClockMap::centroid() const {
  double area = 0, offset = 0, slope = 0;
  const Line& origin = corners_[0];
  for (int i = 1; i + 1 < corner_count_; ++i) {
    const Line& a = corners_[i];
    const Line& b = corners_[i + 1];
    const double cross = (a.offset_s - origin.offset_s) * (b.slope - origin.slope) -
                         (b.offset_s - origin.offset_s) * (a.slope - origin.slope);
    area += cross;
    offset += cross * (a.offset_s + b.offset_s + origin.offset_s) / 3;
    slope += cross * (a.slope + b.slope + origin.slope) / 3;
  }
  if (std::abs(area) < 1e-18) return origin;
  return {offset / area, slope / area};
}

std::optional<HostTime> ClockMap::to_host(McuTime mcu) const {
  if (count_ == 0) return std::nullopt;
  const double offset_s = line_.at(since_first_s(mcu) - pivot_s_);
  return first_host_ + (mcu - first_mcu_) + Duration(std::llround(offset_s * 1e9));
}

std::optional<Duration> ClockMap::bound(McuTime mcu) const {
  if (count_ == 0) return std::nullopt;
  const double x = since_first_s(mcu) - pivot_s_;
  double worst_s = 0;
  for (int i = 0; i < corner_count_; ++i) {
    worst_s = std::max(worst_s, std::abs(corners_[i].at(x) - line_.at(x)));
  }
  return Duration(std::llround(worst_s * 1e9));
}

}  // namespace mixrig::sync
