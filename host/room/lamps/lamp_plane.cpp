// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/lamp_plane.h"

#include <cmath>

#include "host/math/geometry/lamp.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLeastSine = 0.087;  ///< 5 degrees

}  // namespace

std::optional<PanelSpot> spot_on_plane(const BrightRegion& region,
                                       const geometry::Pose& world_from_camera,
                                       const Vector3d& point_m, const Vector3d& normal) {
  const Vector3d eye = world_from_camera.translation_m;
  const double height_m = normal.dot(point_m - eye);
  const geometry::PanelAxes axes = geometry::panel_axes(normal);
  double area = 0;
  Vector2d sum = Vector2d::Zero(), squares = Vector2d::Zero();
  for (const RegionRay& r : region.rays) {
    const Vector3d ray = world_from_camera.rotation * r.direction;
    const double sine = normal.dot(ray);
    if (!(std::abs(sine) > kLeastSine) || !(height_m / sine > 0)) return {};
    const double t_m = height_m / sine;
    const Vector3d off = eye + t_m * ray - point_m;
    const Vector2d at(axes.u.dot(off), axes.v.dot(off));
    const double weight = r.solid_angle_sr * t_m * t_m / std::abs(sine);
    area += weight, sum += weight * at, squares += weight * at.cwiseProduct(at);
  }
  if (!(area > 0)) return {};
  const Vector2d mean = sum / area;
  const Vector2d variance = (squares / area - mean.cwiseProduct(mean)).cwiseMax(0.0);
  return PanelSpot{point_m + mean.x() * axes.u + mean.y() * axes.v, (12 * variance).cwiseSqrt()};
}

}  // namespace mixrig::lights
