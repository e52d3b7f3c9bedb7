// SPDX-License-Identifier: Apache-2.0
// The share of a lamp that points see past the casters (percentage-closer soft shadows, Fernando
// 2005), a register of points at a time, and where that share is 1 for sure.
#pragma once

#include <array>

#include "host/render/cpu/light/shadow.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {

/// Share of the lamp that each point sees, 0..1. `position_m`, `normal` (unit; 0 of a surface that
/// is not in the map, so that it cannot shade itself): camera axes, finite. Of points that are not
/// `wanted` it may be 1.
FloatLanes visibility(const LampParams& lamp, const ShadowMap& map, const VectorLanes& position_m,
                      const VectorLanes& normal, IntLanes wanted = IntLanes{} - 1);
/// The same of surfaces that are in the map, which are found there themselves: it is not asked
/// first whether anything lies under the filters.
FloatLanes visibility_of_caster(const LampParams& lamp, const ShadowMap& map,
                                const VectorLanes& position_m, const VectorLanes& normal,
                                IntLanes wanted = IntLanes{} - 1);

/// A convex part of the space before the camera, by its eight corners in camera axes: of two faces.
struct Corners {
  struct Face {
    F4 x_m, y_m, z_m;
  };
  std::array<Face, 2> faces;
};

/// Whether any point within may see less than all of the lamp. false is sure: `visibility` is 1
/// for every point inside, with any normal.
bool may_be_shadowed(const LampParams& lamp, const ShadowMap& map, const Corners& corners);

}  // namespace mixrig::render::cpu
