// SPDX-License-Identifier: Apache-2.0
// Inspection images as colour pictures.
#pragma once

#include "hal/base/image.h"

namespace mixrig::report {

/// Depth as colour: warm is near, cold is far, black is unknown. From near_m to far_m.
Image<Rgb8> depth_picture(ImageView<const float> depth_m, float near_m, float far_m);
/// The 1st and 99th percentile of known depths; {0, 1} if none is known.
std::pair<float, float> depth_range(ImageView<const float> depth_m);
/// PixelState as colour: foreground white, edge yellow, background blue, unknown dark grey.
Image<Rgb8> key_picture(ImageView<const std::uint8_t> state);
/// Light 0..1 as grey, sRGB encoded.
Image<Rgb8> light_picture(ImageView<const float> light);
/// Area mean of a picture on a smaller grid (nearest pixel where it is larger).
Image<Rgb8> shrunk(ImageView<const Rgb8> picture, Size size);

}  // namespace mixrig::report
