// SPDX-License-Identifier: Apache-2.0
// A room with one bright bar as a camera on a pan-tilt head sees it, computed from the head's angle
// without the pipeline's chain and cameras.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

namespace mixrig::test {

/// The camera stands on the pan axis. A pan is positive to the left, seen from the camera.
struct TurningRoom {
  double focal_px = 0, centre_px = 0;  ///< of a pinhole without distortion
  static constexpr double kHalfBar_rad = 0.03;
  static constexpr int kWall = 60, kBar = 200;

  /// Column in which the middle of the bar, straight ahead at angle 0, stands at a pan.
  double bar_px(double pan_rad) const { return centre_px + focal_px * std::tan(pan_rad); }
  /// Luminance of column x: the mean over the pixel's width.
  int luminance(int x, double pan_rad) const {
    const double from = centre_px + focal_px * std::tan(pan_rad - kHalfBar_rad);
    const double to = centre_px + focal_px * std::tan(pan_rad + kHalfBar_rad);
    const double covered = std::clamp(std::min(x + 0.5, to) - std::max(x - 0.5, from), 0.0, 1.0);
    return kWall + static_cast<int>(std::lround(covered * (kBar - kWall)));
  }
};

/// Middle of the bar in a row whose luminances are `at(x)`; NaN where there is none.
inline double bar_in_row(int width, const std::function<int(int)>& at) {
  double sum = 0, moment = 0;
  for (int x = 0; x < width; ++x) {
    const double bright = std::max(0, at(x) - (TurningRoom::kWall + 10));
    sum += bright;
    moment += bright * x;
  }
  return moment / sum;
}

}  // namespace mixrig::test
