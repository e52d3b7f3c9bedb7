// SPDX-License-Identifier: Apache-2.0
// Corners between two planes of a depth picture, and the depth error near them. A phase camera sees
// two walls too far by the light that bounces between them, least of all in their corner, where the
// detour is short: against the walls beside it the corner is seen too near.
#pragma once

#include <array>
#include <vector>

#include "host/capture/depth/seen_planes.h"

namespace mixrig::depth {

/// Limits of the distances from a corner in which its error is given.
inline constexpr std::array<double, 5> kCornerLimits_m{0, 0.05, 0.1, 0.2, 0.35};
inline constexpr std::size_t kCornerBands = kCornerLimits_m.size() - 1;

struct SeenCorner {
  double angle_deg = 0;  ///< between the planes inside the room, fitted beyond the last limit
  double distance_m = 0;
  /// Median of measured less fitted distance along the ray, by the distance from the corner; NaN
  /// where too few pixels agree.
  std::array<double, kCornerBands> error_m{};
};

/// Finds concave corners of 60 to 120 degrees between planes that touch in the picture. Both
/// planes are fitted to what lies 0.35 to 1.5 m from the corner; these fits give the true surface.
std::vector<SeenCorner> find_corners(ImageView<const float> z_m, const PixelRays& rays,
                                     const CellGrid& grid, const std::vector<SeenPlane>& planes);

}  // namespace mixrig::depth
