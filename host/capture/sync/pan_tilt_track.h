// SPDX-License-Identifier: Apache-2.0
// Interpolates the position of a pan-tilt head between two queries.
#pragma once

#include <array>
#include <optional>

#include "hal/base/clock.h"
#include "hal/device/pan_tilt.h"

namespace mixrig::sync {

/// The last positions of both axes, each with its own time. Nothing allocates. For one thread.
class PanTiltTrack {
 public:
  void add(const device::PanTiltSample& sample);
  /// Interpolates linearly between neighbouring samples of each axis; samples that differ must be
  /// at most kHold apart. After the newest sample the head is assumed to stand still if its last
  /// two positions are equal and at most kHold old. Empty in every other case, since the motion is
  /// unknown.
  std::optional<device::PanTiltAngles> at(HostTime time) const;
  static constexpr Duration kHold = std::chrono::milliseconds(500);

 private:
  static constexpr std::size_t kKept = 128;
  /// Equal positions closer in time are merged.
  static constexpr Duration kSpacing = std::chrono::milliseconds(5);
  struct Point {
    HostTime at{};
    double rad = 0;
  };
  class Axis {
   public:
    void add(Point point);
    std::optional<double> at(HostTime time) const;

   private:
    const Point& kept(std::size_t i) const { return points_[(begin_ + i) % kKept]; }
    std::array<Point, kKept> points_{};
    std::size_t begin_ = 0, count_ = 0;
  };
  Axis pan_, tilt_;
};

}  // namespace mixrig::sync
