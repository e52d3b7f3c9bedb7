// SPDX-License-Identifier: Apache-2.0
// Large planes of a panorama (walls, floor, ceiling, tables), and surfaces drawn onto them.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Planes that take up at least 0.08 sr, the largest first, at most 16. Hypotheses from normals at
/// places of a fixed sequence, refined by least squares of inverse distances, which are linear in
/// the ray on a plane. Only what views measured counts.
std::vector<RoomPlane> find_planes(const Panorama& panorama);

/// The plane that a pixel was found on: its index, or kNoPlane.
inline constexpr std::uint8_t kNoPlane = 255;

/// Moves distances onto a plane where their mean over a neighbourhood lies within one sigma or 3 mm
/// of it, less and less up to twice that, so that what stands off the plane is kept. Returns the
/// planes of the pixels.
Image<std::uint8_t> straighten(const std::vector<RoomPlane>& planes, Panorama& panorama,
                               Crew& crew);

}  // namespace mixrig::model
