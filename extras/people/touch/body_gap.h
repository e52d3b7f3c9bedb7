// SPDX-License-Identifier: Apache-2.0
// Finds how near the unseen side of a body may be to an object.
#pragma once

#include <optional>

#include "extras/people/touch/contact.h"
#include "extras/people/touch/moment.h"
#include "extras/people/touch/shape.h"

namespace mixrig::touch {

/// Models legs and trunk as an upright cylinder around the axis that the tracker knows.
struct BodyProxy {
  /// Lower end, and upper end as a share of the person's height.
  static constexpr double kFoot_m = 0.1, kTop = 0.82;
  static constexpr double kRadius_m = 0.15, kRadiusSigma_m = 0.04;
  Eigen::Vector2d on_floor_m = Eigen::Vector2d::Zero();
  double height_m = 0;  ///< of the person
  double sigma_m = 0;   ///< standard deviation of the cylinder's side
};
BodyProxy proxy_of(const plan::Person& person);

/// Gap of the proxy's deepest point in the object, among the points that its own seen surface hides
/// from the camera; nullopt where no such point is near. Pure.
std::optional<Gap> body_gap(const BodyProxy& body, const Shape& shape,
                            const geometry::Pose& world_from_object,
                            const plan::SegmentedView& seen);

}  // namespace mixrig::touch
