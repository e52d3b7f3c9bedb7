// SPDX-License-Identifier: Apache-2.0
// The size of a picture by its header, before memory is taken for its pixels.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::image_io {

/// Returns the size that the header of PNG or JPEG bytes states, at most 16384 pixels a side.
/// `name` appears in the error line. Errors: kFormat.
Result<Size> picture_size(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace mixrig::image_io
