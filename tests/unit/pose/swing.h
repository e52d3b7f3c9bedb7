// SPDX-License-Identifier: Apache-2.0
// A camera that swings and turns: its pose at any time in closed form.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "host/capture/capture/capture.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::pose {

/// 0.4 m at 0.5 Hz sideways, 0.5 rad at 0.4 Hz about a tilted axis: up to 1.3 m/s and 1.3 rad/s.
inline geometry::Pose swing(double t_s) {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.2, -0.3, 1).normalized();
  const double angle_rad = 0.5 * std::sin(2 * std::numbers::pi * 0.4 * t_s);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis)),
          {1 + 0.4 * std::sin(std::numbers::pi * t_s), 2 + 0.1 * t_s, 1.5}};
}

/// Samples of swing() on a clock that reads `clock_s` when the take's clock reads 0.
inline std::vector<trajectory::TimedPose> swing_samples(double from_s, double to_s, double rate_hz,
                                                        double clock_s = 0) {
  std::vector<trajectory::TimedPose> samples;
  const int count = static_cast<int>(std::lround((to_s - from_s) * rate_hz));
  for (int i = 0; i <= count; ++i) {
    const double t_s = from_s + i / rate_hz;
    samples.push_back({t_s + clock_s, swing(t_s)});
  }
  return samples;
}

inline capture::Capture capture_at(double t_s, int number = 1) {
  capture::Capture capture;
  capture.number = number;
  capture.time_s = t_s;
  capture.mid_exposure = HostTime(Duration(std::llround(t_s * 1e9)));
  return capture;
}

struct PoseDistance {
  double turn_rad = 0, shift_m = 0;
};
inline PoseDistance distance(const geometry::Pose& a, const geometry::Pose& b) {
  return {a.rotation.angularDistance(b.rotation), (a.translation_m - b.translation_m).norm()};
}

}  // namespace mixrig::pose
