// SPDX-License-Identifier: Apache-2.0
// The depth filters of Cortes Reina (2015, section 2.3.3): a window around each pixel. They are
// compared with the compositor's own correction (docs/method/depth.md), not part of it.
#pragma once

#include "hal/base/image.h"

namespace mixrig::depth {

/// A square window with sides of 2 radius_px + 1 pixels. Radius 0 changes nothing.
struct Window {
  int radius_px = 0;
  /// Standard deviation of the spatial weight, pixels.
  double sigma_px() const { return 0.5 * radius_px; }
};

// In all filters unknown depths (0) and pixels outside the picture have no weight, and unknown
// depths stay unknown. Precondition: `out` has the size of `depth_m` and is another picture.

/// Gaussian filter (equation 41), normalised by the weights of the known depths.
void gaussian(ImageView<const float> depth_m, Window window, ImageView<float> out);
/// Takes the lower median of the known depths of the window.
void median(ImageView<const float> depth_m, Window window, ImageView<float> out);
/// Bilateral filter (equations 42 and 43) with Gaussian kernels; `sigma_m` is that of f, over the
/// depth.
void bilateral(ImageView<const float> depth_m, Window window, double sigma_m, ImageView<float> out);
/// Joint bilateral filter (equations 44 and 45) with Gaussian kernels: f over the depth, g over the
/// luma of the plate (0..1, same view). Unlike the others it fills unknown depths, from their
/// window by g alone.
void joint_bilateral(ImageView<const float> depth_m, ImageView<const float> luma, Window window,
                     double sigma_m, double sigma_luma, ImageView<float> out);

}  // namespace mixrig::depth
