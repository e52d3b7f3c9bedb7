// SPDX-License-Identifier: Apache-2.0
// Large planes of a panorama (walls, floor, ceiling, tables), and the projection of surfaces onto
// them.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Finds planes that take up at least 0.08 sr, the largest first, at most 16. Hypotheses come from
/// normals at a fixed sequence of places, and are refined by least squares of inverse distances,
/// which are linear in the ray on a plane. Only measured pixels count.
std::vector<RoomPlane> find_planes(const Panorama& panorama);

/// Index of a pixel that lies on no plane, in the image of straighten().
inline constexpr std::uint8_t kNoPlane = 255;

/// Moves distances onto a plane where their mean over a neighbourhood lies within one sigma or 3 mm
/// of it, and partly up to twice that, so that what stands off the plane is kept. Returns the index
/// of each pixel's plane, or kNoPlane.
Image<std::uint8_t> straighten(const std::vector<RoomPlane>& planes, Panorama& panorama,
                               Crew& crew);

}  // namespace mixrig::model
