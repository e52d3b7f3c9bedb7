// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/plane.h"

#include <Eigen/Eigenvalues>

namespace mixrig::geometry {

Result<Plane> fit_plane(std::span<const Eigen::Vector3d> points_m) {
  if (points_m.size() < 3) return Error{ErrorCode::kData, "a plane needs at least 3 points"};
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& p : points_m) centre += p;
  centre /= static_cast<double>(points_m.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : points_m) scatter += (p - centre) * (p - centre).transpose();
  if (!scatter.allFinite()) return Error{ErrorCode::kData, "a point of the plane is not finite"};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  // Collinear points: the middle spread is as small as rounding leaves it.
  if (solver.eigenvalues()[1] <= 1e-12 * solver.eigenvalues()[2] || solver.eigenvalues()[2] <= 0.0)
    return Error{ErrorCode::kData, "the points lie on one line: no plane"};
  Plane plane;
  plane.normal = solver.eigenvectors().col(0);
  plane.offset_m = -plane.normal.dot(centre);
  return plane;
}

}  // namespace mixrig::geometry
