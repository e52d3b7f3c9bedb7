// SPDX-License-Identifier: Apache-2.0
// What virtual objects hide of the ambient light, and send instead, a register of points at a time
// (contact_shade.h).
#pragma once

#include "host/render/cpu/light/visibility.h"

namespace mixrig::render::cpu {

struct ContactLanes {
  FloatLanes open{};   ///< share of the ambient light that is left
  VectorLanes sent{};  ///< red, green, blue, as LightParams::ambient
};

enum class Receiver { kReal, kObject };

/// Of points in camera axes with unit normals. Points of an object are lifted off it.
ContactLanes contact_at(const FrameParams& frame, const VectorLanes& position_m,
                        const VectorLanes& normal, Receiver receiver);

/// Whether an object may hide ambient light from any point within; false is sure.
bool may_be_near(const FrameParams& frame, const Corners& corners);

}  // namespace mixrig::render::cpu
