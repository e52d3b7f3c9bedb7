// SPDX-License-Identifier: Apache-2.0
// Errors of a simplified room mesh against the distances that it was made from.
#pragma once

#include <cstdint>
#include <span>

#include "hal/base/image.h"

namespace mixrig::measure {

/// Change by simplification, along the rays of a picture's pixels.
struct MeshErrors {
  double mean_mm = 0, p95_mm = 0, max_mm = 0;  ///< of the absolute difference of distances
  double uncovered_pct = 0;                    ///< share of known pixels that no triangle covers
};

/// `distance_m`: equirectangular as in room_errors(), 0 unknown; only pixels within 45 degrees of
/// the horizon count. `positions_m`: x y z of each vertex, in axes of the picture; `indices`: three
/// for each triangle. Where several triangles meet a ray the nearest counts.
MeshErrors mesh_errors(std::span<const float> positions_m, std::span<const std::uint32_t> indices,
                       ImageView<const float> distance_m);

}  // namespace mixrig::measure
