// SPDX-License-Identifier: Apache-2.0
// A measured pixel as a direction with its uncertainty: what triangulation and PnP see of a
// camera, so that they work alike for pinhole and fisheye, beyond 180 degrees too.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "host/geometry/camera_model.h"
#include "host/geometry/fisheye_model.h"

namespace mixrig::estimation {

/// Unit direction in camera axes, and the map from a small change of it to pixel standard
/// deviations: whitener * (direction_of_point - direction) has unit covariance.
struct Bearing {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 2, 3> whitener = Eigen::Matrix<double, 2, 3>::Zero();
};

/// Bearing of a pixel with isotropic noise; nullopt where the camera has no ray there.
std::optional<Bearing> bearing_of(const geometry::CameraModel& camera, const Eigen::Vector2d& px,
                                  double sigma_px);

std::optional<Bearing> bearing_of(const geometry::FisheyeModel& camera, const Eigen::Vector2d& px,
                                  double sigma_px);

/// Bearing of a direction (any length > 0) with isotropic angular noise.
Bearing bearing_of(const Eigen::Vector3d& direction, double sigma_rad);

}  // namespace mixrig::estimation
