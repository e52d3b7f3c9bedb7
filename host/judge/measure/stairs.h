// SPDX-License-Identifier: Apache-2.0
// Judges whether silhouettes of virtual objects are as even and as soft as those of real things.
#pragma once

#include <cstdint>
#include <span>

#include "hal/base/image.h"
#include "host/judge/measure/errors.h"

namespace mixrig::measure {

/// Length of the border pieces (px) that are compared with a straight line.
inline constexpr int kStairPiece_px = 16;

/// Sums over the straight pieces of a layer's border.
struct Stairs {
  Sum off_line_px;  ///< mean_off_line_px() of each piece
  Sum width_px;     ///< width of the brightness step across the border, from 10 to 90 %
};

/// Adds the border between `layer` and the background (by the truth's labels) where both sides are
/// even for 6 px and differ by 24 of 255 in luma. The border lies where half of the step is.
void add_stairs(ImageView<const Rgb8> color, ImageView<const std::uint8_t> labels,
                std::uint8_t layer, Stairs& sums);

/// Mean distance of border positions, one for each pixel along the border, from their least-squares
/// line. Precondition: at least two.
double mean_off_line_px(std::span<const double> places_px);

}  // namespace mixrig::measure
