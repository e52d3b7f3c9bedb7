// SPDX-License-Identifier: Apache-2.0
// Intensities of found lamps, from measurements of their light.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/room/lamps/shading.h"

namespace mixrig::lights {

/// Sum of all lamps' intensities where no light was measured: an assumption for a common room.
inline constexpr float kAssumedIntensity = 8;

/// Intensity of each lamp for a scene, linear RGB. `light`: measured by the room's shading; where
/// it is not usable, kAssumedIntensity is divided among the lamps. `radiance`: of each lamp,
/// relative, from a bracket, or empty. A bracket divides the sum by radiance times area (colours
/// stay); without one, lamps whose light was not measured have the same radiance.
std::vector<Eigen::Vector3f> lamp_intensities(std::span<const FoundLamp> lamps,
                                              const estimation::Estimate<RoomLight>& light,
                                              std::span<const double> radiance);

}  // namespace mixrig::lights
