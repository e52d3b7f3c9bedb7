// SPDX-License-Identifier: Apache-2.0
// Errors of a mesh of a room against the distances that it was made of.
#pragma once

#include <cstdint>
#include <span>

#include "hal/base/image.h"

namespace mixrig::measure {

/// What simplification changed, along the rays of a picture's pixels.
struct MeshErrors {
  double mean_mm = 0, p95_mm = 0, max_mm = 0;  ///< of the size of the difference of distances
  double uncovered_pct = 0;                    ///< share of known pixels that no triangle covers
};

/// `distance_m`: equirectangular as room_errors() has it, 0 unknown. Of pixels within 45 degrees of
/// the horizon. `positions_m`: x y z of each vertex, in axes of the picture; `indices`: three a
/// triangle. Where several triangles meet a ray the nearest counts.
MeshErrors mesh_errors(std::span<const float> positions_m, std::span<const std::uint32_t> indices,
                       ImageView<const float> distance_m);

}  // namespace mixrig::measure
