// SPDX-License-Identifier: Apache-2.0
// What people hide of wide lamps around the objects, at the points of a grid: what lies between
// them is interpolated, since no penumbra there is narrower than a cell by much.
#pragma once

#include <span>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/light/grid_lanes.h"
#include "host/render/cpu/light/lamp_set.h"
#include "host/render/cpu/light/shadow.h"

namespace mixrig::render::cpu {

/// Radius of the least disc, in cells, that a lamp has whose penumbrae of people are told from the
/// corners of cells.
inline constexpr float kWideInCells = 2;

struct PeopleGrid {
  RoomShadeParams at;        ///< where its points lie
  LampSet lamps = 0;         ///< that it knows in this frame
  std::vector<float> share;  ///< of each lamp that a point sees past people: [lamp][z][y][x]
  std::size_t points() const {
    return static_cast<std::size_t>(at.cells.x) * static_cast<std::size_t>(at.cells.y) *
           static_cast<std::size_t>(at.cells.z);
  }
  const float* of(std::size_t lamp) const { return share.data() + lamp * points(); }
};

/// Looks from each point of the grid at those `lamps` among `wanted` that are wide enough for its
/// cells, past `maps`. Allocates in the first frame only.
void find_people_grid(Crew& crew, const RoomShadeParams& at, std::span<const LampParams> lamps,
                      std::span<const ShadowMap> maps, LampSet wanted, PeopleGrid& grid);

}  // namespace mixrig::render::cpu
