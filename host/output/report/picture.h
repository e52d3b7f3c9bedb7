// SPDX-License-Identifier: Apache-2.0
// Turns inspection images into colour pictures.
#pragma once

#include <string>

#include "hal/base/image.h"

namespace mixrig::report {

/// Colour of an error 0..1: white, orange, red along its square root, red beyond 1; black if
/// unknown (negative or NaN).
Rgb8 error_color(float share);
/// Picture of error / most by error_color(), with a scale below it.
Image<Rgb8> error_picture(ImageView<const float> error, float most, const std::string& unit);
/// Colour of a depth share: warm is near (0), cold is far (1); clamped.
Rgb8 depth_color(float share);
/// Depth as colour between near_m and far_m: warm is near, cold is far, black is unknown.
Image<Rgb8> depth_picture(ImageView<const float> depth_m, float near_m, float far_m);
/// The 1st and 99th percentile of known depths; {0, 1} if none is known.
std::pair<float, float> depth_range(ImageView<const float> depth_m);
/// Colour of one PixelState, as in key_picture().
Rgb8 key_color(std::uint8_t state);
/// PixelState as colour: foreground white, edge yellow, background blue, unknown dark grey.
Image<Rgb8> key_picture(ImageView<const std::uint8_t> state);
/// Light 0..1 as grey, sRGB encoded.
Image<Rgb8> light_picture(ImageView<const float> light);
/// Resamples a picture to a smaller size by area means (nearest pixel if the size is larger).
Image<Rgb8> shrunk(ImageView<const Rgb8> picture, Size size);

}  // namespace mixrig::report
