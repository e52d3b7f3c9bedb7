// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/views/turn_plan.h"

#include <algorithm>
#include <cmath>

namespace mixrig::calibration {
namespace {

constexpr double kMargin = 0.04;  ///< of the picture, about the board's corners

/// Element `index` (from 1) of van der Corput's sequence, 0..1.
double radical_inverse(int index, int base) {
  double value = 0, digit = 1;
  for (; index > 0; index /= base) {
    digit /= base;
    value += digit * (index % base);
  }
  return value;
}

double free_angle(double low_px, double high_px, double size_px, double focal_px) {
  const double margin_px = kMargin * size_px;
  const double free_px = std::min(low_px, size_px - 1 - high_px) - margin_px;
  return std::atan(std::max(free_px, 0.0) / focal_px);
}

}  // namespace

device::PanTiltAngles turn_reach(const BoardView& board, const geometry::CameraModel& camera) {
  Eigen::Vector2d low = board.px.front(), high = low;
  for (const Eigen::Vector2d& px : board.px) low = low.cwiseMin(px), high = high.cwiseMax(px);
  const geometry::Pinhole& lens = camera.pinhole;
  return {free_angle(low.x(), high.x(), lens.size_px.width, lens.fx_px),
          free_angle(low.y(), high.y(), lens.size_px.height, lens.fy_px)};
}

std::vector<device::PanTiltAngles> turn_angles(device::PanTiltAngles middle,
                                               device::PanTiltAngles reach, int views,
                                               const device::PanTiltInfo& unit) {
  std::vector<device::PanTiltAngles> angles{middle};
  for (int i = 1; i < views; ++i) {
    const double pan = middle.pan_rad + reach.pan_rad * (2 * radical_inverse(i, 2) - 1);
    const double tilt = middle.tilt_rad + reach.tilt_rad * (2 * radical_inverse(i, 3) - 1);
    angles.push_back({std::clamp(pan, unit.minimum.pan_rad, unit.maximum.pan_rad),
                      std::clamp(tilt, unit.minimum.tilt_rad, unit.maximum.tilt_rad)});
  }
  return angles;
}

}  // namespace mixrig::calibration
