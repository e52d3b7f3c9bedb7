// SPDX-License-Identifier: Apache-2.0
// The share of a lamp that points see past the casters (percentage-closer soft shadows, Fernando
// 2005), a register of points at a time, and where that share is 1 for sure.
#pragma once

#include <array>

#include "host/render/cpu/shadow.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {

/// Share of the lamp that each point sees, 0..1. `position_m`, `normal` (unit; 0 of a surface that
/// is not in the map, so that it cannot shade itself): camera axes, finite. Of points that are not
/// `wanted` it may be 1.
FloatLanes visibility(const LampParams& lamp, const ShadowMap& map, const VectorLanes& position_m,
                      const VectorLanes& normal, IntLanes wanted = IntLanes{} - 1);

/// A convex part of the space before the camera, by its corners in camera axes.
using Corners = std::array<glm::vec3, 8>;

/// Whether any point within may see less than all of the lamp. false is sure: `visibility` is 1
/// for every point inside, with any normal.
bool may_be_shadowed(const LampParams& lamp, const ShadowMap& map, const Corners& corners_m);

}  // namespace mixrig::render::cpu
