// SPDX-License-Identifier: Apache-2.0
// Errors of a room model against the true room: distances in all directions around one place.
#pragma once

#include <array>
#include <cstddef>

#include "hal/base/image.h"

namespace mixrig::measure {

/// Room whose walls are at 0 and `inner_m` along each world axis, with the frame of the directions:
/// p_world = rotation (row by row) * p + origin_m.
struct RoomFrame {
  std::array<double, 3> inner_m{}, origin_m{};
  std::array<double, 9> world_from_axes{};
};

/// Lengths between opposite walls at random places (Schiller et al. 2010, table 1).
struct WallToWall {
  int count = 0;
  double mean_mm = 0, p95_mm = 0, max_mm = 0;  ///< of the absolute error
};

struct RoomErrors {
  std::array<WallToWall, 3> axes;  ///< x (width), y (depth), z (height) of the world
  double p50_mm = 0, p95_mm = 0;   ///< distance of a model point to the plane of the true surface
  double over_20mm_pct = 0;        ///< share of known directions with a larger distance
  std::size_t points = 0;
};

/// Compares two equirectangular pictures of one size: column x at azimuth pi - 2 pi (x + 0.5) /
/// width, counter-clockwise from +y about +z, row y at elevation pi/2 - pi (y + 0.5) / height.
/// Distances in metres, 0 = unknown. Takes `count` lengths per axis where the walls are free within
/// half a degree around both ends and the model knows them; fewer where not enough are found.
/// Shares and quantiles are of solid angle.
RoomErrors room_errors(ImageView<const float> model_m, ImageView<const float> true_m,
                       const RoomFrame& frame, int count);

/// Distance of the model's point to the plane of the true surface in each direction, millimetres;
/// -1 where one of the two is not known, and in the last row.
Image<float> off_surface_mm(ImageView<const float> model_m, ImageView<const float> true_m);

}  // namespace mixrig::measure
