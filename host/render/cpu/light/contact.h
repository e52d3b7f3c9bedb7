// SPDX-License-Identifier: Apache-2.0
// Ambient light that virtual objects hide, and light that they send instead, for a register of
// points at a time (contact_shade.h).
#pragma once

#include "host/render/cpu/light/visibility.h"

namespace mixrig::render::cpu {

struct ContactLanes {
  FloatLanes open{};   ///< remaining share of the ambient light
  VectorLanes sent{};  ///< red, green, blue in units of LightParams::ambient
};

enum class Receiver { kReal, kObject };

/// Contact light at points in camera axes with unit normals. Points of an object are lifted off it.
ContactLanes contact_at(const FrameParams& frame, const VectorLanes& position_m,
                        const VectorLanes& normal, Receiver receiver);

/// Whether an object may hide ambient light from any point inside; false is certain.
bool may_be_near(const FrameParams& frame, const Corners& corners);

}  // namespace mixrig::render::cpu
