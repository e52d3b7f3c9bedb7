// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/device_clock.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "hal/base/order_statistics.h"

namespace mixrig::sync {
namespace {

constexpr double kLongestSpan_s = 1.0;  // 256 s in all: longer than a crystal warms up
constexpr double kJump_s = 0.5;         // longer than any delay of a live stream
constexpr int kOutliersToRestart = 3;
constexpr double kLargestDrift = 5e-3;  // 5000 ppm: stamps that drift more are unusable
constexpr int kRounds = 4;
constexpr int kFewest = 10;  // fewest points for a line

}  // namespace

DeviceClock::Verdict DeviceClock::add(DeviceTime stamp, HostTime received) {
  if (!started_) {
    reset(stamp, received);
    return Verdict::kOk;
  }
  const double stamp_s = seconds(stamp - first_stamp_);
  const double delay_s = seconds(received - first_received_) - stamp_s;
  const bool backwards = stamp_s < last_stamp_s_ - kJump_s;
  const bool far = std::abs(delay_s - line(stamp_s)) > kJump_s;
  outliers_in_row_ = far ? outliers_in_row_ + 1 : 0;
  if (backwards || outliers_in_row_ >= kOutliersToRestart) {
    ++restarts_;
    reset(stamp, received);
    return Verdict::kRestarted;
  }
  if (far) return Verdict::kOk;
  last_stamp_s_ = std::max(last_stamp_s_, stamp_s);
  keep({stamp_s, delay_s});
  return Verdict::kOk;
}

std::optional<HostTime> DeviceClock::to_host(DeviceTime stamp) const {
  if (!started_) return std::nullopt;
  const Duration since = stamp - first_stamp_;
  const double moved_s = line(seconds(since));
  return first_received_ + since + Duration(std::llround(moved_s * 1e9));
}

void DeviceClock::reset(DeviceTime stamp, HostTime received) {
  started_ = true;
  first_stamp_ = stamp;
  first_received_ = received;
  points_[0] = {0, 0};
  count_ = 1;
  span_s_ = 0.1;
  span_end_s_ = span_s_;
  last_stamp_s_ = 0;
  offset_s_ = slope_ = 0;
  jitter_ = {};
  outliers_in_row_ = 0;
}

void DeviceClock::keep(Point point) {
  Point& last = points_[static_cast<std::size_t>(count_ - 1)];
  if (point.stamp_s < span_end_s_) {
    // Delays within a span differ by jitter, not by drift: the least one has the least jitter.
    if (point.delay_s >= last.delay_s) return;
    last = point;
    if (count_ < kFewest) offset_s_ = std::min(offset_s_, point.delay_s);
    return;
  }
  if (count_ >= kFewest) fit();
  if (count_ == kPoints) thin_out();
  points_[static_cast<std::size_t>(count_++)] = point;
  span_end_s_ = point.stamp_s + span_s_;
  if (count_ < kFewest) offset_s_ = std::min(offset_s_, point.delay_s);
}

/// Frees space: merges neighbouring spans until they reach kLongestSpan_s, then drops the oldest.
void DeviceClock::thin_out() {
  if (span_s_ >= kLongestSpan_s) {
    std::copy(points_.begin() + 1, points_.end(), points_.begin());
    --count_;
    return;
  }
  for (std::size_t i = 0; i < kPoints / 2; ++i) {
    const Point &a = points_[2 * i], &b = points_[2 * i + 1];
    points_[i] = a.delay_s <= b.delay_s ? a : b;
  }
  count_ = kPoints / 2;
  span_s_ = std::min(2 * span_s_, kLongestSpan_s);
}

/// Fits the line by least squares with Tukey's weights; the scale is the median absolute residual.
void DeviceClock::fit() {
  const auto n = static_cast<std::size_t>(count_);
  std::array<double, kPoints> scratch;
  for (std::size_t i = 0; i < n; ++i) scratch[i] = points_[i].delay_s;
  double offset = upper_median_in_place(std::span(scratch.data(), n)), slope = slope_, scale = 0;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < n; ++i)
      scratch[i] = std::abs(points_[i].delay_s - offset - slope * points_[i].stamp_s);
    scale = std::max(1.4826 * upper_median_in_place(std::span(scratch.data(), n)), 1e-6);
    const double cut = (round == 0 ? 1e3 : 4.7) * scale;
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Point& p = points_[i];
      const double u = (p.delay_s - offset - slope * p.stamp_s) / cut;
      if (std::abs(u) >= 1) continue;
      const double weight = (1 - u * u) * (1 - u * u);
      w += weight, x += weight * p.stamp_s, y += weight * p.delay_s;
      xx += weight * p.stamp_s * p.stamp_s, xy += weight * p.stamp_s * p.delay_s;
    }
    const double spread = xx * w - x * x;
    if (w <= 0) break;
    if (spread > 1e-9) slope = std::clamp((xy * w - x * y) / spread, -kLargestDrift, kLargestDrift);
    offset = (y - slope * x) / w;
  }
  offset_s_ = offset;
  slope_ = slope;
  jitter_ = Duration(std::llround(scale * 1e9));
}

}  // namespace mixrig::sync
