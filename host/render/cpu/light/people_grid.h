// SPDX-License-Identifier: Apache-2.0
// What people hide of wide lamps around the objects, at points of a grid and interpolated between
// them: no penumbra there is much narrower than a cell.
#pragma once

#include <span>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/light/grid_lanes.h"
#include "host/render/cpu/light/lamp_set.h"
#include "host/render/cpu/light/shadow.h"

namespace mixrig::render::cpu {

/// Least radius of a lamp's disc, in cells, at which people's penumbrae may be interpolated between
/// corners of cells.
inline constexpr float kWideInCells = 2;

struct PeopleGrid {
  RoomShadeParams at;        ///< where the points of the grid lie
  LampSet lamps = 0;         ///< lamps that the grid holds in this frame
  std::vector<float> share;  ///< share of each lamp that a point sees past people: [lamp][z][y][x]
  std::size_t points() const {
    return static_cast<std::size_t>(at.cells.x) * static_cast<std::size_t>(at.cells.y) *
           static_cast<std::size_t>(at.cells.z);
  }
  const float* of(std::size_t lamp) const { return share.data() + lamp * points(); }
};

/// Computes the grid for those `lamps` in `wanted` that are wide enough for its cells, by `maps`.
/// Allocates in the first frame only.
void find_people_grid(Crew& crew, const RoomShadeParams& at, std::span<const LampParams> lamps,
                      std::span<const ShadowMap> maps, LampSet wanted, PeopleGrid& grid);

}  // namespace mixrig::render::cpu
