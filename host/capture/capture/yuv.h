// SPDX-License-Identifier: Apache-2.0
// Converts YUV pictures to R'G'B'. Private to this module.
#pragma once

#include "hal/base/image.h"
#include "hal/base/raw_picture.h"
#include "hal/device/camera.h"
#include "hal/device/frame.h"

namespace mixrig::capture {

/// Convert by matrix and range of `encoding`. Preconditions: the frame is whole, `out` has its
/// size, rows of NV12 hold an even number of bytes. Allocate nothing.
void decode_yuyv(const device::Frame& frame, const device::ColorEncoding& encoding,
                 Image<Rgb8>& out);
void decode_nv12(const device::Frame& frame, const device::ColorEncoding& encoding,
                 Image<Rgb8>& out);

/// Returns the conversion of one pixel, equal to that of both functions to the bit.
YuvToRgb yuv_to_rgb(const device::ColorEncoding& encoding);

}  // namespace mixrig::capture
