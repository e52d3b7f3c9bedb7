// SPDX-License-Identifier: Apache-2.0
// Projects a bright region onto a plane: centre and size of a flat lamp.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "host/math/geometry/pose.h"
#include "host/room/lamps/bright_regions.h"

namespace mixrig::lights {

struct PanelSpot {
  Eigen::Vector3d centre_m;  ///< centre of its area on the plane
  Eigen::Vector2d size_m;  ///< rectangle along geometry::panel_axes() with the same second moments
};

/// Finds the centre of a flat lamp, which is not the middle of its solid angle since its near half
/// looks larger: each ray counts by the area that it covers on the plane. Nullopt if the region has
/// no ray, or rays meet the plane behind the camera or at less than 5 degrees.
std::optional<PanelSpot> spot_on_plane(const BrightRegion& region,
                                       const geometry::Pose& world_from_camera,
                                       const Eigen::Vector3d& point_m,
                                       const Eigen::Vector3d& normal);

}  // namespace mixrig::lights
