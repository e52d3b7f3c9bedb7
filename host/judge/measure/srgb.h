// SPDX-License-Identifier: Apache-2.0
// sRGB bytes and linear light (IEC 61966-2-1), for what judges: the pipeline has its own.
#pragma once

#include <cstdint>

namespace mixrig::measure {

/// Linear light 0..1 of a byte.
float linear_of(std::uint8_t srgb);
/// The nearest byte; what is outside 0..1 is cut.
std::uint8_t srgb_of(float linear);

}  // namespace mixrig::measure
