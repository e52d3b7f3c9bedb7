// SPDX-License-Identifier: Apache-2.0
// The studio's own lenses: Brown-Conrady and fisheye, from pixels to rays.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "studio/studio.h"

namespace mixrig::studio {

/// Distorted position of the ideal point (x/z, y/z); OpenCV's formula with k1 k2 p1 p2 k3.
Eigen::Vector2d distort(const Optics& optics, const Eigen::Vector2d& ideal);
/// The ideal point of a distorted one, by damped fixed-point iteration to 1e-12.
Eigen::Vector2d undistort(const Optics& optics, const Eigen::Vector2d& distorted);
/// Pixel of a point in camera axes; z must be > 0.
Eigen::Vector2d project(const Optics& optics, const Eigen::Vector3d& p);

/// Rays of all pixels: ideal coordinates at the pixel corners, interpolated bilinearly in between
/// (error below 1e-3 px for the lenses of the presets).
class RayGrid {
 public:
  RayGrid() = default;
  explicit RayGrid(const Optics& optics);

  Size size() const { return size_; }
  /// (x/z, y/z) at pixel coordinates; (0,0) is the centre of the top-left pixel.
  Eigen::Vector2f at(float u_px, float v_px) const;

 private:
  Size size_;
  std::vector<Eigen::Vector2f> corners_;
};

/// Unit ray of a fisheye pixel, by Newton's method; false outside the image circle.
bool fisheye_ray(const FisheyeOptics& optics, double u_px, double v_px, Eigen::Vector3d& ray);

}  // namespace mixrig::studio
