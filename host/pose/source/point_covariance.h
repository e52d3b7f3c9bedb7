// SPDX-License-Identifier: Apache-2.0
// Uncertainty of a point's pixel that follows from the pose's.
#pragma once

#include <Eigen/Core>

#include "host/capture/capture/pose_source.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::pose {

/// Returns the covariance, px^2, of the pixel of a point of the world, to first order: the Jacobian
/// of the pinhole by the pose times `covariance`. Precondition: the point lies in front of the
/// camera.
Eigen::Matrix2d point_covariance(const Eigen::Vector3d& world_m,
                                 const geometry::Pose& world_from_camera,
                                 const capture::PoseCovariance& covariance,
                                 const geometry::Pinhole& view);

}  // namespace mixrig::pose
