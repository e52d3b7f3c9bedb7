// SPDX-License-Identifier: Apache-2.0
// Colour pictures out of what cameras send.
#pragma once

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "hal/device/frame.h"

namespace mixrig::rig {

/// 8-bit sRGB of any frame but depth; keeps the memory of `out`. YUV is taken as BT.601 with
/// limited range, which is what UVC cameras send; Bayer is interpolated bilinearly; 16-bit grey
/// keeps its upper byte. Errors: kData where the bytes are fewer than the picture needs, or the
/// format has no colours; kFormat of a damaged JPEG.
Result<void> decode_rgb8(const device::Frame& frame, Image<Rgb8>& out);

}  // namespace mixrig::rig
