// SPDX-License-Identifier: Apache-2.0
// Rigid transforms, named b_from_a: p_b = b_from_a * p_a.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hal/base/result.h"

namespace mixrig::geometry {

/// A rotation and a translation in metres. `b_from_a * p_a` is the point in frame b.
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();

  bool operator==(const Pose&) const = default;
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation_m; }
  /// c_from_b * b_from_a = c_from_a.
  Pose operator*(const Pose& right) const {
    return {(rotation * right.rotation).normalized(),
            rotation * right.translation_m + translation_m};
  }
  Eigen::Matrix4d matrix() const;
};

/// Returns a_from_b.
Pose inverse(const Pose& b_from_a);

/// Pose of a 3x3 matrix that is a rotation to within `tolerance` (largest element of R^T R - 1,
/// and det > 0). Errors: kData, for a singular, mirrored or scaled matrix, or one that holds NaN.
Result<Pose> pose_from_matrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m,
                              double tolerance = 1e-3);

/// Pose of a camera at `eye` that looks at `target`, with image down as close to -`up` as can be
/// (camera axes x right, y down, z forward). Precondition: eye != target, up not along the view.
Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up);

}  // namespace mixrig::geometry
