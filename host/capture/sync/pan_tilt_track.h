// SPDX-License-Identifier: Apache-2.0
// Interpolates the position of a pan-tilt head between two queries.
#pragma once

#include <array>
#include <optional>

#include "hal/base/clock.h"
#include "hal/device/pan_tilt.h"

namespace mixrig::sync {

/// The last positions of both axes, each with its own time. Nothing allocates. One thread.
class PanTiltTrack {
 public:
  void add(const device::PanTiltSample& sample);
  /// Linear between neighbouring samples of each axis, different ones at most `kHold` apart. After
  /// the newest one the head is assumed to stand still if its last two positions are equal and at
  /// most `kHold` old; empty in every other case: nobody knows how the head moved.
  std::optional<device::PanTiltAngles> at(HostTime time) const;
  static constexpr Duration kHold = std::chrono::milliseconds(500);

 private:
  static constexpr std::size_t kKept = 128;
  static constexpr Duration kSpacing = std::chrono::milliseconds(5);  ///< of equal positions
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
