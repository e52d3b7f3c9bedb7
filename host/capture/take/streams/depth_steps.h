// SPDX-License-Identifier: Apache-2.0
// Depth and amplitude as 16-bit steps. Private to this module.
#pragma once

#include <cstdint>

#include "hal/base/image.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

/// What a 16-bit step of a stream means: value = offset + step * unit.
struct Steps {
  double unit = 1, offset = 0;
  int unknown = 0;  ///< step that means no value, which is 0
};

inline Steps depth_steps(const TakeInfo& info) {
  return {info.depth_unit_m, info.depth_offset_m, info.depth_unknown};
}

inline Steps depth_steps(const capture::SecondDepthCamera& camera) {
  return {camera.unit_m, camera.offset_m, camera.unknown};
}

/// Floats in steps, rounded; not finite, not positive or out of range becomes unknown. Reuses the
/// memory of `out`.
void to_steps(const Image<float>& image, const Steps& steps, Image<std::uint16_t>& out);
/// The inverse. Reuses the memory of `out`.
void from_steps(const Image<std::uint16_t>& image, const Steps& steps, Image<float>& out);

}  // namespace mixrig::take
