// SPDX-License-Identifier: Apache-2.0
// Finds areas that float before a wall, hanging things or the depth of a mirror, and holes in
// walls. Private to this module.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Area of surfaces before a plane, joined without a depth step, whose border lies on the plane.
struct FloatingArea {
  Eigen::Vector3d direction;  ///< unit vector to its middle
  double solid_angle_sr = 0;
  double noise = 0;  ///< median of sigma / distance^2 over that of the plane around the area: how
                     ///< much less light returns than from the plane
  std::vector<std::array<int, 2>> pixels;
};

/// Finds floating areas of at least 9 square degrees.
std::vector<FloatingArea> floating_areas(const Panorama& panorama,
                                         std::span<const RoomPlane> planes);

/// Makes floating areas unknown that are far noisier than the wall behind them: so little light
/// does not fit their distance, which has wrapped around behind a mirror. Adds their directions to
/// Panorama::wrapped.
void forget_wrapped(Panorama& panorama);

/// Fills what no view measured by the plane that seven tenths of its border lie on: mirrors, glass
/// and black things in a wall return no light, and people before them are keyed by the wall's
/// depth. Panorama::views stays 0 there. Adds those that nothing filled before to
/// Panorama::flat_holes.
void fill_flat_holes(Panorama& panorama);

}  // namespace mixrig::model
