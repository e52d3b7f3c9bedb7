// SPDX-License-Identifier: Apache-2.0
// Units of angles.
#pragma once

#include <numbers>

namespace mixrig {

inline constexpr double kPi = std::numbers::pi;
inline constexpr float kPi_f = std::numbers::pi_v<float>;
/// Radians of a degree: an angle in degrees times it is one in radians.
inline constexpr double kDeg = kPi / 180;

}  // namespace mixrig
