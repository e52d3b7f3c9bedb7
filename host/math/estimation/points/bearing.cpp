// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/bearing.h"

#include <Eigen/Geometry>

namespace mixrig::estimation {

std::optional<Bearing> bearing_of(const geometry::CameraModel& camera, const Eigen::Vector2d& px,
                                  double sigma_px) {
  const auto ideal = camera.unproject(px);
  if (!ideal) return std::nullopt;
  const Eigen::Vector3d ray(ideal->x(), ideal->y(), 1.0);
  const double length = ray.norm();
  const Eigen::Vector3d d = ray / length;
  // d(x/z, y/z) / d direction, at the unit direction.
  Eigen::Matrix<double, 2, 3> slope;
  slope << 1, 0, -ideal->x(), 0, 1, -ideal->y();
  slope *= length;
  const Eigen::Vector2d focal(camera.pinhole.fx_px, camera.pinhole.fy_px);
  return Bearing{d, focal.asDiagonal() * camera.lens.jacobian(*ideal) * slope / sigma_px,
                 Eigen::Vector3d::UnitZ()};
}

std::optional<Bearing> bearing_of(const geometry::FisheyeModel& camera, const Eigen::Vector2d& px,
                                  double sigma_px) {
  const auto direction = camera.unproject(px);
  if (!direction) return std::nullopt;
  return Bearing{*direction, camera.jacobian(*direction) / sigma_px, Eigen::Vector3d::Zero()};
}

Bearing bearing_of(const Eigen::Vector3d& direction, double sigma_rad) {
  Bearing bearing;
  bearing.direction = direction.normalized();
  const Eigen::Vector3d u = bearing.direction.unitOrthogonal();
  bearing.whitener.row(0) = u.transpose() / sigma_rad;
  bearing.whitener.row(1) = bearing.direction.cross(u).transpose() / sigma_rad;
  return bearing;
}

}  // namespace mixrig::estimation
