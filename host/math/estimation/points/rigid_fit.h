// SPDX-License-Identifier: Apache-2.0
// Rigid and similarity transform between two sets of corresponding points.
#pragma once

#include <optional>
#include <span>

#include "host/math/estimation/verdict.h"
#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

/// p_b = scale * rotation * p_a + translation.
struct Similarity {
  double scale = 1.0;
  geometry::Pose pose;
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const {
    return scale * (pose.rotation * p) + pose.translation_m;
  }
};

struct RigidFitOptions {
  /// Standard deviation of each coordinate of b - transform(a), m. If it is given,
  /// outliers are searched for too; if not, it is estimated from the residuals of all points.
  std::optional<double> sigma_m;
  /// Relative weights (inverse variances), one per point; empty: all 1.
  std::span<const double> weights;
};

/// Least squares over rotations with determinant +1 (Arun 1987 with Umeyama's 1991 sign;
/// Cortes Reina 2015, eq. 82 lacks the sign and mirrors coplanar sets). Covariance: see
/// pose_error(), 6x6. Residuals: distance |b - transform(a)| in m, one per point. Degenerate: fewer
/// than 3 points, collinear or coinciding points, mirror images, contradicting sets, values that
/// are not finite.
Estimate<geometry::Pose> rigid_fit(std::span<const Eigen::Vector3d> a_m,
                                   std::span<const Eigen::Vector3d> b_m,
                                   const RigidFitOptions& options = {});

/// Does what rigid_fit() does, with a common scale; covariance 7x7, the last parameter is
/// log(scale).
Estimate<Similarity> similarity_fit(std::span<const Eigen::Vector3d> a_m,
                                    std::span<const Eigen::Vector3d> b_m,
                                    const RigidFitOptions& options = {});

/// Returns the least-squares pose of the points named by `indices`, without covariance and verdict
/// (inner step of other estimators). nullopt for fewer than 3 points or a spread of zero.
std::optional<geometry::Pose> align_points(std::span<const Eigen::Vector3d> a_m,
                                           std::span<const Eigen::Vector3d> b_m,
                                           std::span<const int> indices);

}  // namespace mixrig::estimation
