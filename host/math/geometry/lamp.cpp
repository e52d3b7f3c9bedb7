// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/lamp.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace mixrig::geometry {

PanelAxes panel_axes(const Eigen::Vector3d& normal) {
  constexpr double kFlat = 0.9;
  const Eigen::Vector3d along = std::abs(normal.z()) > kFlat
                                    ? Eigen::Vector3d(Eigen::Vector3d::UnitX())
                                    : Eigen::Vector3d::UnitZ().cross(normal);
  const Eigen::Vector3d u = (along - along.dot(normal) * normal).normalized();
  return {u, normal.cross(u)};
}

double irradiance(const Lamp& lamp, const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal) {
  constexpr double kLeast_m2 = 1e-6;
  const Eigen::Vector3d to_lamp = lamp.position_m - at_m;
  const double distance2 = std::max(to_lamp.squaredNorm(), kLeast_m2);
  const Eigen::Vector3d toward = to_lamp / std::sqrt(distance2);
  const double emitter = lamp.direction ? std::max(0.0, -lamp.direction->dot(toward)) : 1.0;
  return std::max(0.0, normal.dot(toward)) * emitter / distance2;
}

}  // namespace mixrig::geometry
