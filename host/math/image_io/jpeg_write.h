// SPDX-License-Identifier: Apache-2.0
// Encodes JPEG in memory.
#pragma once

#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::image_io {

/// Returns the bytes of a baseline JPEG with colour at half the resolution; quality 1 to 100.
/// Errors: kIo for an image without pixels or with more than 16384 a side.
Result<std::string> encode_jpeg(ImageView<const Rgb8> image, int quality);

}  // namespace mixrig::image_io
