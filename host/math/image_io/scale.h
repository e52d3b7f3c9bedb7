// SPDX-License-Identifier: Apache-2.0
// Scales a picture.
#pragma once

#include "hal/base/image.h"

namespace mixrig::image_io {

/// Scales a picture to fill `size` without stretching; the excess is cut off equally on both sides.
/// Filtered (libyuv). Precondition: neither size is empty; at most 16384 pixels a side.
Image<Rgb8> scaled_to_fill(ImageView<const Rgb8> picture, Size size);

}  // namespace mixrig::image_io
