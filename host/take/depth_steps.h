// SPDX-License-Identifier: Apache-2.0
// Depth and amplitude as 16-bit steps. Private to this room.
#pragma once

#include <cstdint>

#include "hal/base/image.h"

namespace mixrig::take {

/// Floats in steps of `unit`, rounded; not finite, negative or too large becomes `unknown`. Reuses
/// the memory of `steps`.
void to_steps(const Image<float>& image, double unit, int unknown, Image<std::uint16_t>& steps);

}  // namespace mixrig::take
