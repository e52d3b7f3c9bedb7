// SPDX-License-Identifier: Apache-2.0
// A measured pixel as a direction with its uncertainty. Triangulation and PnP use only bearings, so
// that they work for pinhole and fisheye lenses, also beyond 180 degrees.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/fisheye_model.h"

namespace mixrig::estimation {

/// Unit direction in camera axes, and the map from a small change of it to pixel standard
/// deviations: whitener * (direction_of_point - direction) has unit covariance.
struct Bearing {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 2, 3> whitener = Eigen::Matrix<double, 2, 3>::Zero();
  /// Normal of the plane in which a pinhole measures, camera axes; zero: measured on the unit
  /// sphere.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// Returns the whitened error of a point in camera axes. With a normal it is exactly that of an
/// ideal pinhole's pixel. Points near the plane's horizon or behind the camera are compared on the
/// sphere, where they never count as visible.
template <typename T>
Eigen::Matrix<T, 2, 1> bearing_error(const Bearing& bearing, const Eigen::Matrix<T, 3, 1>& p) {
  const T length = p.norm();
  const T along = p.dot(bearing.normal.cast<T>());
  const double expected = bearing.normal.dot(bearing.direction);
  constexpr double kHorizon = 0.2;
  const bool in_plane = expected > 0 && along > kHorizon * expected * length;
  const Eigen::Matrix<T, 3, 1> seen = in_plane ? Eigen::Matrix<T, 3, 1>(p * (T(expected) / along))
                                               : Eigen::Matrix<T, 3, 1>(p / length);
  const Eigen::Matrix<T, 3, 1> off = seen - bearing.direction.cast<T>();
  return bearing.whitener.cast<T>() * off;
}

/// Bearing of a pixel with isotropic noise; nullopt where the camera has no ray there.
std::optional<Bearing> bearing_of(const geometry::CameraModel& camera, const Eigen::Vector2d& px,
                                  double sigma_px);

std::optional<Bearing> bearing_of(const geometry::FisheyeModel& camera, const Eigen::Vector2d& px,
                                  double sigma_px);

/// Bearing of a direction (any length > 0) with isotropic angular noise.
Bearing bearing_of(const Eigen::Vector3d& direction, double sigma_rad);

}  // namespace mixrig::estimation
