// SPDX-License-Identifier: Apache-2.0
// Whether the silhouettes of virtual things are as even and as soft as those of real ones.
#pragma once

#include <cstdint>
#include <span>

#include "hal/base/image.h"
#include "host/judge/measure/errors.h"

namespace mixrig::measure {

/// Pixels along a border that are held against one straight line.
inline constexpr int kStairPiece_px = 16;

/// Sums over the straight pieces of a layer's border.
struct Stairs {
  Sum off_line_px;  ///< mean_off_line_px() of each
  Sum width_px;     ///< from 10 to 90 % of the step of brightness, across the border
};

/// Adds the border of `layer` to the background (by the truth's labels) where both sides are even
/// for 6 px and differ by 24 of 255 in luma. Where a border passes is where half of the step is.
void add_stairs(ImageView<const Rgb8> color, ImageView<const std::uint8_t> labels,
                std::uint8_t layer, Stairs& sums);

/// Mean distance of the places of a border, one a pixel along it, from the line through them (least
/// squares). Precondition: at least two.
double mean_off_line_px(std::span<const double> places_px);

}  // namespace mixrig::measure
