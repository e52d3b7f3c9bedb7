// SPDX-License-Identifier: Apache-2.0
// Finds where something moves in a picture, by comparing pixels.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/image.h"

namespace mixrig::measure {

/// Mean column of the pixels that differ by more than 90 of 765 (red, green and blue together) from
/// `empty`, a picture without the moving thing. nullopt where these are fewer than 0.1 % or the
/// sizes differ. Checks every second pixel and row, except those that `left_out` marks (not 0; it
/// may be empty).
std::optional<double> changed_column(ImageView<const Rgb8> picture, ImageView<const Rgb8> empty,
                                     ImageView<const std::uint8_t> left_out = {});
std::optional<double> changed_column(ImageView<const Rgbx8> picture, ImageView<const Rgb8> empty,
                                     ImageView<const std::uint8_t> left_out = {});

}  // namespace mixrig::measure
