// SPDX-License-Identifier: Apache-2.0
// How near the side of a body that nothing sees may be to an object.
#pragma once

#include <optional>

#include "extras/people/touch/contact.h"
#include "extras/people/touch/moment.h"
#include "extras/people/touch/shape.h"

namespace mixrig::touch {

/// An upright cylinder for legs and trunk, around the axis that the tracker knows.
struct BodyProxy {
  static constexpr double kFoot_m = 0.1, kTop = 0.82;  ///< of it; the top is a share of the height
  static constexpr double kRadius_m = 0.15, kRadiusSigma_m = 0.04;
  Eigen::Vector2d on_floor_m = Eigen::Vector2d::Zero();
  double height_m = 0;  ///< of the person
  double sigma_m = 0;   ///< of its side
};
BodyProxy proxy_of(const plan::Person& person);

/// Of the points of the proxy that its own seen surface hides from the camera, the deepest in the
/// object; none where no such point is near. Pure.
std::optional<Gap> body_gap(const BodyProxy& body, const Shape& shape,
                            const geometry::Pose& world_from_object,
                            const plan::SegmentedView& seen);

}  // namespace mixrig::touch
