// SPDX-License-Identifier: Apache-2.0
// Draws depth samples into another view in a plain way: each as a square of its own footprint,
// nearest wins. Shares nothing with the compositor's warp.
#pragma once

#include <array>

#include "hal/base/image.h"
#include "host/judge/measure/slip.h"

namespace mixrig::measure {

/// (x/z, y/z) of a sample in the axes of its camera; NaN where it has no ray.
struct Ray {
  float x = 0, y = 0;
};

/// p_view = rotation (row by row) * p_samples + translation.
struct Motion {
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  Point3 translation_m{};
};

/// Draws samples (z in metres; 0, negative or not finite: unknown) into `out_m`, which has the size
/// of the view and may hold depth already: a pixel changes only where a sample is nearer, and 0 is
/// empty. `rays` has the size of `z_m`. A square is as wide as a sample's distance from its right
/// or lower neighbour, at least one pixel.
void splat(ImageView<const float> z_m, ImageView<const Ray> rays, const Motion& view_from_samples,
           const IdealView& view, ImageView<float> out_m);

}  // namespace mixrig::measure
