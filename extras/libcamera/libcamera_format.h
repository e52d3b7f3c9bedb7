// SPDX-License-Identifier: Apache-2.0
// Converts libcamera's pixel formats (DRM codes with a modifier) to V4L2 codes. Pure.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/wire/camera/v4l2_format.h"

namespace mixrig::device {

/// Modifier of drm_fourcc.h: Bayer and grey samples packed as MIPI CSI-2 sends them.
inline constexpr std::uint64_t kDrmCsi2Packed = 0x0B00000000000001;

/// V4L2 code of the format in `planes` buffers; 0 where mixrig does not read it.
std::uint32_t v4l2_of_drm(std::uint32_t code, std::uint64_t modifier, std::size_t planes);

}  // namespace mixrig::device
