// SPDX-License-Identifier: Apache-2.0
// Conversion between sRGB bytes and linear light (IEC 61966-2-1) for the judging code; the pipeline
// has its own.
#pragma once

#include <cstdint>

namespace mixrig::measure {

/// Linear light, 0..1, of an sRGB byte.
float linear_of(std::uint8_t srgb);
/// Nearest sRGB byte; values outside 0..1 are clamped.
std::uint8_t srgb_of(float linear);

}  // namespace mixrig::measure
