// SPDX-License-Identifier: Apache-2.0
// Converts pixels to rays with their uncertainty, for any lens.
#pragma once

#include <optional>
#include <vector>

#include "host/math/estimation/points/bearing.h"
#include "host/math/geometry/any_camera.h"

namespace mixrig::reconstruction {

/// Ray of a pixel. Its error is measured on the sphere and whitened by the lens' own derivative
/// there, so that a pixel has equal weight in the middle and at the rim. nullopt where the lens has
/// no ray, and less than `margin_rad` inside the largest angle that a fisheye states.
std::optional<estimation::Bearing> ray_of(const geometry::AnyCamera& camera,
                                          const Eigen::Vector2d& px, double sigma_px,
                                          double margin_rad = 0);

/// Whitened error of a point in camera axes against a ray, in standard deviations.
template <typename T>
Eigen::Matrix<T, 2, 1> ray_error(const estimation::Bearing& ray, const Eigen::Matrix<T, 3, 1>& p) {
  const Eigen::Matrix<T, 3, 1> off = p / p.norm() - ray.direction.cast<T>();
  return ray.whitener.cast<T>() * off;
}

}  // namespace mixrig::reconstruction
