// SPDX-License-Identifier: Apache-2.0
// Converts depth and amplitude to and from 16-bit steps. Private to this module.
#pragma once

#include <cstdint>

#include "hal/base/image.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

/// Meaning of the 16-bit steps of a stream: value = offset + step * unit.
struct Steps {
  double unit = 1, offset = 0;
  int unknown = 0;  ///< step that means "no value"; from_steps() makes it 0
};

inline Steps depth_steps(const TakeInfo& info) {
  return {info.depth_unit_m, info.depth_offset_m, info.depth_unknown};
}

inline Steps depth_steps(const capture::SecondDepthCamera& camera) {
  return {camera.unit_m, camera.offset_m, camera.unknown};
}

/// Converts floats to steps, rounded; values that are not finite, not positive or out of range
/// become unknown. Reuses the memory of `out`.
void to_steps(const Image<float>& image, const Steps& steps, Image<std::uint16_t>& out);
/// Converts steps to floats; unknown steps and negative values become 0. Reuses the memory of
/// `out`.
void from_steps(const Image<std::uint16_t>& image, const Steps& steps, Image<float>& out);

}  // namespace mixrig::take
