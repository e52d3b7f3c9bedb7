// SPDX-License-Identifier: Apache-2.0
// Measures the shift between two pictures, and its uncertainty by their noise.
#pragma once

#include "hal/base/image.h"

namespace mixrig::live {

struct PictureShift {
  double x_px = 0, y_px = 0;
  double sigma_x_px = 0, sigma_y_px = 0;  ///< 0: the pictures do not determine it

  /// Whether the shift is within `least_px`, or within 3.5 sigma, of 0.
  bool is_none(double least_px) const;
  double length_px() const;
};

/// Translation from a to b, for shifts below about a pixel: least squares over the gradients in
/// each of 8 x 6 blocks (Lucas and Kanade 1981), then the median of the blocks weighted by
/// 1/sigma^2, so that motion in a minority of them has no effect. A block counts if its gradients
/// exceed the noise that the residuals show. Values of 0 and below are unknown. Pictures of
/// different sizes, or without a block that counts, give a shift of 0 with sigma 0.
PictureShift shift_between(ImageView<const float> a, ImageView<const float> b);

/// Computes the mean of red, green twice, and blue, plus one, so that it is always above 0. Reuses
/// the memory of `out`.
void luminance_of(const Image<Rgb8>& plate, Image<float>& out);

}  // namespace mixrig::live
