// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/views/rays.h"

#include <cmath>

namespace mixrig::reconstruction {

std::optional<estimation::Bearing> ray_of(const geometry::AnyCamera& camera,
                                          const Eigen::Vector2d& px, double sigma_px,
                                          double margin_rad) {
  const auto direction = geometry::unproject(camera, px);
  if (!direction) return std::nullopt;
  const auto most_rad = geometry::max_angle_rad(camera);
  if (most_rad && std::acos(std::min(1.0, direction->z())) > *most_rad - margin_rad)
    return std::nullopt;
  const Eigen::VectorXd parameters = geometry::parameters_of(camera);
  const auto projection =
      geometry::project_with_jacobians(geometry::kind_of(camera), parameters.data(), *direction);
  if (!projection || !projection->d_point.allFinite()) return std::nullopt;
  estimation::Bearing ray;
  ray.direction = *direction;
  ray.whitener = projection->d_point / sigma_px;
  return ray;
}

}  // namespace mixrig::reconstruction
