// SPDX-License-Identifier: Apache-2.0
// Slip: distance in the picture between where a point of the world is drawn and where the true
// camera pose shows it. Has a projection of its own.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/base/quantile_sketch.h"

namespace mixrig::measure {

using Point3 = std::array<double, 3>;  ///< metres
using PixelPoint = std::array<double, 2>;

/// p_world = rotation * p_camera + translation; camera axes x right, y down, z forward.
struct CameraPlace {
  std::array<double, 4> rotation_xyzw{0, 0, 0, 1};  ///< of length 1
  Point3 translation_m{};
};

/// An ideal pinhole, in pixels.
struct IdealView {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
};

/// Pixel where a camera shows a point of the world; nullopt for a point less than 1 cm ahead of it.
std::optional<PixelPoint> pixel_of(const Point3& world_m, const CameraPlace& world_from_camera,
                                   const IdealView& view);

/// Variances xx, yy and covariance xy of an error, px^2.
struct PixelCovariance {
  double xx = 0, yy = 0, xy = 0;
};

/// Whether an error lies in the ellipse that holds 95 % of normal errors of this covariance:
/// e^T S^-1 e <= 5.991. False for a covariance that is not positive definite.
bool within_95_pct(const PixelPoint& error_px, const PixelCovariance& covariance);

/// Distances of many points, in constant memory.
class SlipSums {
 public:
  /// Adds the distance of one point, px.
  void add(double distance_px);
  std::uint64_t count() const { return distances_.count(); }
  double rms_px() const;  ///< 0 without points
  double quantile_px(double q) const { return distances_.quantile(q); }
  double max_px() const { return distances_.max(); }

 private:
  double square_px2_ = 0;
  QuantileSketch distances_;
};

}  // namespace mixrig::measure
