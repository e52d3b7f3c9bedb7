// SPDX-License-Identifier: Apache-2.0
// sRGB (IEC 61966-2-1) to linear light and back. Private to this room.
#pragma once

#include <array>
#include <cstdint>

namespace mixrig::model {

/// Linear value 0..1 of each 8-bit sRGB value.
const std::array<float, 256>& linear_from_srgb();
/// Rounded 8-bit sRGB of a linear value; clamps to 0..1.
std::uint8_t srgb_from_linear(float linear);

}  // namespace mixrig::model
