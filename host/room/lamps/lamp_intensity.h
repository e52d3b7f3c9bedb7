// SPDX-License-Identifier: Apache-2.0
// Intensities of found lamps, from what is known of their light.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/room/lamps/shading.h"

namespace mixrig::lights {

/// Where no light was measured, what all lamps have together, an assumption: a common room's.
inline constexpr float kAssumedIntensity = 8;

/// Intensity of each lamp as a scene has it, linear RGB. `light`: as the room's shading tells it;
/// where it is not usable, kAssumedIntensity is shared out. `radiance`: of each lamp, relative, by
/// a bracket, or empty. A bracket says how the sum is shared out (by radiance times area; the
/// colours stay); without one lamps whose light was not measured have the same radiance.
std::vector<Eigen::Vector3f> lamp_intensities(std::span<const FoundLamp> lamps,
                                              const estimation::Estimate<RoomLight>& light,
                                              std::span<const double> radiance);

}  // namespace mixrig::lights
