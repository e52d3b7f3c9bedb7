// SPDX-License-Identifier: Apache-2.0
// Planes in Hessian form.
#pragma once

#include <span>

#include <Eigen/Core>

#include "hal/base/result.h"

namespace mixrig::geometry {

/// Points p with normal . p + offset_m = 0; normal has length 1.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset_m = 0.0;
  double signed_distance_m(const Eigen::Vector3d& p) const { return normal.dot(p) + offset_m; }
};

/// Total least squares plane of at least three points that are not collinear.
/// Errors: kData where the points do not determine a plane (too few, collinear, not finite).
Result<Plane> fit_plane(std::span<const Eigen::Vector3d> points_m);

}  // namespace mixrig::geometry
