// SPDX-License-Identifier: Apache-2.0
// Pixel formats as libcamera names them, DRM codes with a modifier, by their V4L2 codes: pure.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/wire/camera/v4l2_format.h"

namespace mixrig::device {

/// drm_fourcc.h: Bayer and grey samples packed as MIPI CSI-2 sends them.
inline constexpr std::uint64_t kDrmCsi2Packed = 0x0B00000000000001;

/// The V4L2 code of the same bytes in `planes` buffers; 0 where mixrig does not read it.
std::uint32_t v4l2_of_drm(std::uint32_t code, std::uint64_t modifier, std::size_t planes);

}  // namespace mixrig::device
