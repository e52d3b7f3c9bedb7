// SPDX-License-Identifier: Apache-2.0
// Share of a lamp that points see past the casters (percentage-closer soft shadows, Fernando 2005),
// for a register of points at a time, and tests where that share is certainly 1.
#pragma once

#include <array>

#include "host/render/cpu/light/shadow.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {

/// Share of the lamp that each point sees, 0..1. `position_m`, `normal`: camera axes, finite; the
/// normal is a unit vector, or 0 for a surface that is not in the map and cannot shade itself.
/// Points that are not `wanted` may get 1.
FloatLanes visibility(const LampParams& lamp, const ShadowMap& map, const VectorLanes& position_m,
                      const VectorLanes& normal, IntLanes wanted = IntLanes{} - 1);
/// Share for surfaces that are in the map themselves: skips the test whether anything lies under
/// the filters, since they do.
FloatLanes visibility_of_caster(const LampParams& lamp, const ShadowMap& map,
                                const VectorLanes& position_m, const VectorLanes& normal,
                                IntLanes wanted = IntLanes{} - 1);

/// A convex part of the space before the camera, by its eight corners in camera axes: two faces of
/// four.
struct Corners {
  struct Face {
    F4 x_m, y_m, z_m;
  };
  std::array<Face, 2> faces;
};

/// Whether any point inside may see less than the whole lamp. False is certain: visibility() is 1
/// for every point inside, with any normal.
bool may_be_shadowed(const LampParams& lamp, const ShadowMap& map, const Corners& corners);

}  // namespace mixrig::render::cpu
