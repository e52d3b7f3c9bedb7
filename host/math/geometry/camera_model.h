// SPDX-License-Identifier: Apache-2.0
// Pinhole cameras with the OpenCV lens models. Pixel (0,0) is the centre of the top-left pixel.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>
#include <Eigen/LU>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::geometry {

/// An ideal pinhole: u = fx x/z + cx, v = fy y/z + cy, in pixels.
struct Pinhole {
  Size size_px;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;

  /// Pixel of a point in camera axes; z must be > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    return {fx_px * p.x() / p.z() + cx_px, fy_px * p.y() / p.z() + cy_px};
  }
  /// Returns (x/z, y/z) of a pixel.
  Eigen::Vector2d unproject(const Eigen::Vector2d& px) const {
    return {(px.x() - cx_px) / fx_px, (px.y() - cy_px) / fy_px};
  }
  bool operator==(const Pinhole&) const = default;
};

/// A Brown-Conrady (k1 k2 p1 p2 k3) or rational lens (k4 k5 k6 too), in OpenCV's order and
/// meaning: x_d = x (1+k1 r2+k2 r4+k3 r6)/(1+k4 r2+k5 r4+k6 r6) + 2 p1 x y + p2 (r2+2x2).
/// Valid out to the radius where the radial mapping stops growing; beyond, there is no pixel.
class Lens {
 public:
  using Coefficients = std::array<double, 8>;  ///< k1 k2 p1 p2 k3 k4 k5 k6
  Lens() : Lens(Coefficients{}) {}
  explicit Lens(const Coefficients& coefficients);

  const Coefficients& coefficients() const { return coefficients_; }
  bool is_ideal() const { return is_ideal_; }
  /// Largest x2 + y2 of ideal coordinates that the lens maps; infinity for an ideal lens.
  double domain_r2() const { return domain_r2_; }

  /// Distorted normalised coordinates of ideal ones; nullopt outside the domain.
  std::optional<Eigen::Vector2d> distort(const Eigen::Vector2d& ideal) const;
  /// Inverse of distort by Newton steps to 1e-12; nullopt where it has no solution.
  std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& distorted) const;
  /// d distort / d ideal, 2x2.
  Eigen::Matrix2d jacobian(const Eigen::Vector2d& ideal) const;

 private:
  Coefficients coefficients_;
  bool is_ideal_;
  double domain_r2_;
};

/// A pinhole behind a lens.
struct CameraModel {
  Pinhole pinhole;
  Lens lens;

  Size size_px() const { return pinhole.size_px; }
  /// Pixel of a point in camera axes; nullopt behind the camera or outside the lens' domain.
  /// May lie outside the picture.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p) const;
  /// (x/z, y/z) of a pixel; nullopt where the lens has no ray.
  std::optional<Eigen::Vector2d> unproject(const Eigen::Vector2d& px) const;
};

/// Checks values read from a file: finite values, positive size and focal lengths, a lens whose
/// mapping is one-to-one over the whole picture. Errors: kData, naming the value.
Result<void> validate(const CameraModel& camera);

/// The ideal view in which a distorted plate is composited: the same focal length and centre
/// unless some view pixel would look past the plate's border; then the smallest zoom that
/// leaves no such pixel. Same size as the plate.
Pinhole ideal_view(const CameraModel& camera);

}  // namespace mixrig::geometry
