// SPDX-License-Identifier: Apache-2.0
// Vignetting: how much darker a lens makes the corners of its picture.
#pragma once

#include <algorithm>
#include <cmath>

#include "host/math/geometry/camera_model.h"

namespace mixrig::geometry {

/// Multiply linear light by factor() to get what the middle of the picture would show. factor() is
/// exp(a r^2 + b r^4), clamped to 1/8..8; r is the distance of a pixel from the principal point
/// over half the picture's diagonal.
struct Vignetting {
  double a = 0, b = 0;

  bool is_none() const { return a == 0 && b == 0; }
  double factor(double r2) const { return std::clamp(std::exp(r2 * (a + r2 * b)), 0.125, 8.0); }
  /// Returns r^2 of a pixel.
  static double radius2(const Pinhole& camera, const Eigen::Vector2d& px) {
    const Eigen::Vector2d size(camera.size_px.width, camera.size_px.height);
    return 4 * (px - Eigen::Vector2d(camera.cx_px, camera.cy_px)).squaredNorm() /
           size.squaredNorm();
  }
  bool operator==(const Vignetting&) const = default;
};

}  // namespace mixrig::geometry
