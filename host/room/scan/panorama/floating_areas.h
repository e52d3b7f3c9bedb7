// SPDX-License-Identifier: Apache-2.0
// What floats before a wall: a thing that hangs, or the depth of a mirror. Private to this module.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Surfaces before a plane, joined without a depth step, whose border lies on the plane.
struct FloatingArea {
  Eigen::Vector3d direction;  ///< of its middle, of unit length
  double solid_angle_sr = 0;
  double noise = 0;  ///< median of sigma / distance^2 over that of the plane around it: how much
                     ///< less light returns than from the plane
  std::vector<std::array<int, 2>> pixels;
};

/// Of at least 9 square degrees.
std::vector<FloatingArea> floating_areas(const Panorama& panorama,
                                         std::span<const RoomPlane> planes);

/// Makes unknown what floats and is noisier by far than the wall behind it: its light is too weak
/// for its distance, which has wrapped around behind a mirror. Its places go to Panorama::wrapped.
void forget_wrapped(Panorama& panorama);

}  // namespace mixrig::model
