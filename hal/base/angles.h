// SPDX-License-Identifier: Apache-2.0
// Units of angles.
#pragma once

#include <numbers>

namespace mixrig {

inline constexpr double kPi = std::numbers::pi;
inline constexpr float kPi_f = std::numbers::pi_v<float>;
/// Radians in one degree: an angle in degrees times it is the angle in radians.
inline constexpr double kDeg = kPi / 180;

}  // namespace mixrig
