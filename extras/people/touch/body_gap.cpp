// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/body_gap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mixrig::touch {
namespace {

constexpr int kAround = 16;
constexpr double kRing_m = 0.1;     ///< of the heights that are looked at
constexpr double kBehind_m = 0.03;  ///< the seen surface, so that it hides the point

bool is_hidden(const Eigen::Vector3d& in_view, const plan::SegmentedView& seen) {
  if (in_view.z() < 0.05) return false;
  const Eigen::Vector2d px = seen.view.project(in_view);
  const Size size = seen.depth_m.size;
  if (!(px.x() >= 0 && px.y() >= 0 && px.x() < size.width && px.y() < size.height)) return false;
  const float z = seen.depth_m.at(static_cast<int>(px.x()), static_cast<int>(px.y()));
  return z > 0 && z < in_view.z() - kBehind_m;
}

}  // namespace

BodyProxy proxy_of(const plan::Person& person) {
  BodyProxy body;
  body.on_floor_m = person.on_floor_m, body.height_m = person.height_m;
  const double place2 = 0.5 * person.covariance.trace();
  body.sigma_m = std::sqrt(place2 + BodyProxy::kRadiusSigma_m * BodyProxy::kRadiusSigma_m);
  return body;
}

std::optional<Gap> body_gap(const BodyProxy& body, const Shape& shape,
                            const geometry::Pose& world_from_object,
                            const plan::SegmentedView& seen) {
  const geometry::Pose object_from_world = geometry::inverse(world_from_object);
  const geometry::Pose view_from_world = geometry::inverse(seen.world_from_view);
  std::optional<Gap> nearest;
  for (double z = BodyProxy::kFoot_m; z < BodyProxy::kTop * body.height_m; z += kRing_m)
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      const Eigen::Vector3d at(body.on_floor_m.x() + BodyProxy::kRadius_m * std::cos(angle),
                               body.on_floor_m.y() + BodyProxy::kRadius_m * std::sin(angle), z);
      const Eigen::Vector3f p = (object_from_world * at).cast<float>();
      if (shape.box_m.squaredExteriorDistance(p) > kNear_m * kNear_m) continue;
      Eigen::Vector3f normal;
      const double d = shape.distance_m(p, normal);
      if (nearest && d >= nearest->m) continue;
      if (is_hidden(view_from_world * at, seen))
        nearest = Gap{d, body.sigma_m, at, Evidence::kProxy};
    }
  return nearest;
}

}  // namespace mixrig::touch
