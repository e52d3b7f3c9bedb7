// SPDX-License-Identifier: Apache-2.0
// The depth filters of paper C, section 2.3.3: a window around each pixel. Rungs to hold the
// compositor's own correction against (docs/method/depth.md), not a part of it.
#pragma once

#include "hal/base/image.h"

namespace mixrig::depth {

/// A square window of 2 `radius_px` + 1. Radius 0 changes nothing.
struct Window {
  int radius_px = 0;
  /// Standard deviation of the weight over the distance in the picture.
  double sigma_px() const { return 0.5 * radius_px; }
};

// Unknown depths (0) count for nothing and stay unknown; what lies outside of the picture counts
// for nothing. Precondition of all: `out` has the size of `depth_m` and is another picture.

/// Equation 41, normalised by the weights of the known depths.
void gaussian(ImageView<const float> depth_m, Window window, ImageView<float> out);
/// The lower median of the known depths of the window.
void median(ImageView<const float> depth_m, Window window, ImageView<float> out);
/// Equations 42 and 43 with Gaussian kernels; `sigma_m` is that of f, over the depth.
void bilateral(ImageView<const float> depth_m, Window window, double sigma_m, ImageView<float> out);
/// Equations 44 and 45 with Gaussian kernels: f over the depth, g over the luma of the plate (0..1,
/// of the same view). Unknown depths are filled from their window by g alone.
void joint_bilateral(ImageView<const float> depth_m, ImageView<const float> luma, Window window,
                     double sigma_m, double sigma_luma, ImageView<float> out);

}  // namespace mixrig::depth
