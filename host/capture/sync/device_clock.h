// SPDX-License-Identifier: Apache-2.0
// Maps a camera's own clock to host time, drift included, from stamps and arrival times.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/base/clock.h"

namespace mixrig::sync {

/// Arrival = stamp + offset + drift + delay, where the delay is never less than a constant and
/// often close to it. The least delay of every short span is kept, and a robust line is fitted to
/// these delays (Moon, Skelly and Towsley, "Estimation and removal of clock skew from network delay
/// measurements", 1999, with a robust fit in place of the convex hull). The first points are too
/// few for a line: until there are ten, the offset is the least delay of all. The constant part of
/// the delay is not observable from stamps; the user of this class has to measure it. Nothing
/// allocates. One thread.
class DeviceClock {
 public:
  enum class Verdict {
    kOk,
    kRestarted,  ///< the device's clock jumped: all earlier samples were dropped
  };
  /// Adds a frame: its stamp by the device's clock and the time of its arrival.
  Verdict add(DeviceTime stamp, HostTime received);

  /// Host time of a device stamp plus the least delay; empty before the first sample.
  std::optional<HostTime> to_host(DeviceTime stamp) const;
  /// (host rate / device rate - 1) * 1e6; 0 during the first second.
  double drift_ppm() const { return slope_ * 1e6; }
  /// Scatter of the kept delays around the line, standard deviation by MAD.
  Duration jitter() const { return jitter_; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  struct Point {
    double stamp_s = 0;  ///< since the first stamp
    double delay_s = 0;  ///< arrival - stamp, less that of the first sample
  };
  static constexpr int kPoints = 256;
  void reset(DeviceTime stamp, HostTime received);
  void keep(Point point);
  void thin_out();
  void fit();
  double line(double stamp_s) const { return offset_s_ + slope_ * stamp_s; }

  std::array<Point, kPoints> points_{};
  int count_ = 0;
  double span_s_ = 0.1;  ///< one point is kept per span
  double span_end_s_ = 0;
  bool started_ = false;
  DeviceTime first_stamp_{};
  HostTime first_received_{};
  double last_stamp_s_ = 0;
  double offset_s_ = 0, slope_ = 0;
  Duration jitter_{};
  int outliers_in_row_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace mixrig::sync
