// SPDX-License-Identifier: Apache-2.0
// Where something moves in a picture, told by its pixels.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/image.h"

namespace mixrig::measure {

/// The mean column of the pixels that differ from a picture without what moves, by more than 90 of
/// 765 (red, green and blue together). Nothing where those are fewer than 0.1 % or the sizes
/// differ. Every second pixel and row is looked at, but for those that `left_out` marks (not 0; it
/// may be empty).
std::optional<double> changed_column(ImageView<const Rgb8> picture, ImageView<const Rgb8> empty,
                                     ImageView<const std::uint8_t> left_out = {});
std::optional<double> changed_column(ImageView<const Rgbx8> picture, ImageView<const Rgb8> empty,
                                     ImageView<const std::uint8_t> left_out = {});

}  // namespace mixrig::measure
