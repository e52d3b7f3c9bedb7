// SPDX-License-Identifier: Apache-2.0
// Light that surfaces of one depth picture throw on each other, computed from their shapes and
// taken out of the distances (analysis by synthesis; Fuchs 2010, "Multipath interference
// compensation in time-of-flight camera images").
#pragma once

#include <optional>
#include <span>

#include "host/capture/depth/seen_planes.h"

namespace mixrig::depth {

/// A phase camera with its light source at the lens, before diffuse surfaces.
struct BounceModel {
  double modulation_hz = 0;
  double reflectivity = 0;  ///< share of infrared light that surfaces reflect, 0 to 1
};

/// Takes out of depths, in place, what one reflection between the surfaces of the picture adds.
/// Light from outside the picture, and further reflections, stay. `z_m`: along the axis, size of
/// the rays; unknown values stay. Time grows with the square of the number of cells.
void take_out_bounce(const BounceModel& model, const PixelRays& rays, ImageView<float> z_m);

/// Mean depth error 50 to 200 mm from the corners between planes, over all pictures.
struct CornerError {
  std::size_t corners = 0;
  double error_m = 0;
};
CornerError corner_error(std::span<const Image<float>> pictures_m, const PixelRays& rays);

/// Finds the reflectivity that straightens the walls beside corners. Nothing where fewer than five
/// corners are seen, where they are off by less than 4 mm, or where no reflectivity up to 0.9 does.
std::optional<double> find_reflectivity(std::span<const Image<float>> pictures_m,
                                        const PixelRays& rays, double modulation_hz);

}  // namespace mixrig::depth
