// SPDX-License-Identifier: Apache-2.0
// Inspection images as colour pictures.
#pragma once

#include <string>

#include "hal/base/image.h"

namespace mixrig::report {

/// Error 0..1 as colour: white, orange, red by its square root, red beyond; black where it is not
/// known (negative, not a number).
Rgb8 error_color(float share);
/// The same of error / most, with a scale below.
Image<Rgb8> error_picture(ImageView<const float> error, float most, const std::string& unit);
/// Warm is near (0), cold is far (1); values beyond are those of the ends.
Rgb8 depth_color(float share);
/// Depth as colour: warm is near, cold is far, black is unknown. From near_m to far_m.
Image<Rgb8> depth_picture(ImageView<const float> depth_m, float near_m, float far_m);
/// The 1st and 99th percentile of known depths; {0, 1} if none is known.
std::pair<float, float> depth_range(ImageView<const float> depth_m);
/// As key_picture, of one pixel.
Rgb8 key_color(std::uint8_t state);
/// PixelState as colour: foreground white, edge yellow, background blue, unknown dark grey.
Image<Rgb8> key_picture(ImageView<const std::uint8_t> state);
/// Light 0..1 as grey, sRGB encoded.
Image<Rgb8> light_picture(ImageView<const float> light);
/// Area mean of a picture on a smaller grid (nearest pixel where it is larger).
Image<Rgb8> shrunk(ImageView<const Rgb8> picture, Size size);

}  // namespace mixrig::report
