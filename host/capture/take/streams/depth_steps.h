// SPDX-License-Identifier: Apache-2.0
// Converts depth and amplitude to and from 16-bit steps. Private to this module.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "hal/base/image.h"
#include "host/capture/take/take.h"

namespace mixrig::take {

inline constexpr std::size_t kMostUnknownSteps = 4;

/// Meaning of the 16-bit steps of a stream: value = offset + step * unit.
struct Steps {
  double unit = 1, offset = 0;
  /// Steps that mean "no value"; from_steps() makes them 0, to_steps() writes the first. -1:
  /// unused.
  std::array<int, kMostUnknownSteps> unknown{0, -1, -1, -1};
  bool is_unknown(int step) const {
    return std::find(unknown.begin(), unknown.end(), step) != unknown.end();
  }
};

/// Returns the steps of the depth stream; `further` are unknown steps beside info.depth_unknown.
inline Steps depth_steps(const TakeInfo& info, std::span<const int> further = {}) {
  Steps steps{info.depth_unit_m, info.depth_offset_m, {info.depth_unknown, -1, -1, -1}};
  std::copy_n(further.begin(), std::min(further.size(), kMostUnknownSteps - 1),
              steps.unknown.begin() + 1);
  return steps;
}

inline Steps depth_steps(const capture::SecondDepthCamera& camera,
                         std::span<const int> further = {}) {
  Steps steps{camera.unit_m, camera.offset_m, {camera.unknown, -1, -1, -1}};
  std::copy_n(further.begin(), std::min(further.size(), kMostUnknownSteps - 1),
              steps.unknown.begin() + 1);
  return steps;
}

/// Converts floats to steps, rounded; values that are not finite, not positive or out of range
/// become unknown. Reuses the memory of `out`.
void to_steps(const Image<float>& image, const Steps& steps, Image<std::uint16_t>& out);
/// Converts steps to floats; unknown steps and negative values become 0. Reuses the memory of
/// `out`.
void from_steps(const Image<std::uint16_t>& image, const Steps& steps, Image<float>& out);

}  // namespace mixrig::take
