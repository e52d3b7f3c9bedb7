// SPDX-License-Identifier: Apache-2.0
// A picture of another size.
#pragma once

#include "hal/base/image.h"

namespace mixrig::image_io {

/// As large as needed to fill `size` without stretching; what hangs over is cut off on both sides.
/// Filtered (libyuv). Precondition: neither is empty; at most 16384 pixels a side.
Image<Rgb8> scaled_to_fill(ImageView<const Rgb8> picture, Size size);

}  // namespace mixrig::image_io
