// SPDX-License-Identifier: Apache-2.0
// Converts to Y'CbCr of ITU-R BT.709, narrow range, 4:2:0, rounded to nearest. GStreamer's
// converter truncates, which costs up to 5 of 255 levels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/image.h"

namespace mixrig::output {

/// Bytes of a picture in GStreamer's I420 layout.
std::size_t i420_bytes(Size size);
/// Converts rows of `stride` bytes with `pixel_bytes` a pixel: 4 (blue, green, red, unused) or 1
/// (grey). Chroma is the mean of 2 x 2 pixels. Precondition: `to` has i420_bytes().
void i420_from(std::span<const std::uint8_t> from, std::size_t stride, std::size_t pixel_bytes,
               Size size, std::span<std::uint8_t> to);

}  // namespace mixrig::output
