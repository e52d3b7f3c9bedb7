// SPDX-License-Identifier: Apache-2.0
// Bands around borders in a picture: where a compositor can be wrong.
#pragma once

#include <cmath>
#include <cstdint>

#include "hal/base/image.h"

namespace mixrig::measure {

/// A matte of at least this is a person.
inline constexpr int kHalfMatte = 128;

/// A depth that was measured: 0, negative and not finite are unknown.
inline bool is_known(float z_m) { return std::isfinite(z_m) && z_m > 0.0F; }

/// 1 within `radius_px` (Euclidean, between pixel centres) of a pixel whose mark is not 0. Else 0.
Image<std::uint8_t> widened(ImageView<const std::uint8_t> marks, int radius_px);

/// 1 within `radius_px` of a pixel at a depth step: one whose known z differs from that of a
/// 4-neighbour by more than `step_m`. Else 0.
Image<std::uint8_t> step_band(ImageView<const float> depth_m, float step_m, int radius_px);

/// 1 within `radius_px` of a pixel at the border of the people: one that is a person (matte of at
/// least kHalfMatte) and has a 4-neighbour that is not, or the other way round. Else 0.
Image<std::uint8_t> matte_band(ImageView<const std::uint8_t> matte, int radius_px);

}  // namespace mixrig::measure
