// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/irradiance.h"

#include <algorithm>
#include <cmath>

namespace mixrig::geometry {

double irradiance(const Eigen::Vector3d& lamp_m, const std::optional<Eigen::Vector3d>& direction,
                  const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal) {
  constexpr double kLeast_m2 = 1e-6;
  const Eigen::Vector3d to_lamp = lamp_m - at_m;
  const double distance2 = std::max(to_lamp.squaredNorm(), kLeast_m2);
  const Eigen::Vector3d toward = to_lamp / std::sqrt(distance2);
  const double emitter = direction ? std::max(0.0, -direction->dot(toward)) : 1.0;
  return std::max(0.0, normal.dot(toward)) * emitter / distance2;
}

}  // namespace mixrig::geometry
