// SPDX-License-Identifier: Apache-2.0
// Masks of bands around borders in a picture, where a compositor can be wrong.
#pragma once

#include <cmath>
#include <cstdint>

#include "hal/base/image.h"

namespace mixrig::measure {

/// A pixel whose matte is at least this value (of 255) counts as a person.
inline constexpr int kHalfMatte = 128;

/// Whether a depth was measured: 0, negative and not finite values are unknown.
inline bool is_known(float z_m) { return std::isfinite(z_m) && z_m > 0.0F; }

/// Mask: 1 within `radius_px` (Euclidean, between pixel centres) of a pixel whose mark is not 0,
/// else 0.
Image<std::uint8_t> widened(ImageView<const std::uint8_t> marks, int radius_px);

/// Mask: 1 within `radius_px` of a pixel whose known z differs from that of a 4-neighbour by more
/// than `step_m`, else 0.
Image<std::uint8_t> step_band(ImageView<const float> depth_m, float step_m, int radius_px);

/// Mask: 1 within `radius_px` of the people's border, else 0. Border pixels are those with a
/// 4-neighbour on the other side of kHalfMatte.
Image<std::uint8_t> matte_band(ImageView<const std::uint8_t> matte, int radius_px);

}  // namespace mixrig::measure
