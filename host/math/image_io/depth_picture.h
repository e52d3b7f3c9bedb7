// SPDX-License-Identifier: Apache-2.0
// Depth pictures: PNG files of 16 bits, never of 8.
#pragma once

#include <cstdint>
#include <filesystem>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::image_io {

/// Reads a grey PNG of 16 bits into `image`, whose memory is reused. Errors: those of
/// read_gray16(); kFormat for 8 bits, which a conversion for display leaves.
Result<void> read_depth16(const std::filesystem::path& path, Image<std::uint16_t>& image);

}  // namespace mixrig::image_io
