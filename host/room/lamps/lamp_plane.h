// SPDX-License-Identifier: Apache-2.0
// A bright region drawn onto a plane: where a flat lamp's middle is, and how large it is.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "host/math/geometry/pose.h"
#include "host/room/lamps/bright_regions.h"

namespace mixrig::lights {

struct PanelSpot {
  Eigen::Vector3d centre_m;  ///< of its area, on the plane
  Eigen::Vector2d size_m;    ///< of the rectangle along geometry::panel_axes() with the same second
                             ///< moments
};

/// The centre of gravity of a flat lamp is not in the middle of its solid angle, since its near
/// half looks larger: each ray counts by the area that it covers on the plane. nullopt where the
/// region has no ray, or rays meet the plane behind or at less than 5 degrees.
std::optional<PanelSpot> spot_on_plane(const BrightRegion& region,
                                       const geometry::Pose& world_from_camera,
                                       const Eigen::Vector3d& point_m,
                                       const Eigen::Vector3d& normal);

}  // namespace mixrig::lights
