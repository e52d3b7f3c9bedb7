// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/people_grid.h"

#include <algorithm>

#include "host/render/cpu/light/visibility.h"

namespace mixrig::render::cpu {
namespace {

/// Iterates over the points (x, y, z) of a layer of the grid, row by row, in camera axes.
class LayerPoints {
 public:
  LayerPoints(const RoomShadeParams& at, int z)
      : camera_from_cell_(glm::inverse(at.cell_from_camera)),
        columns_(at.cells.x),
        row_m_(camera_from_cell_ * glm::vec4(0, 0, static_cast<float>(z), 1)) {}
  /// The next register of points.
  VectorLanes next() {
    VectorLanes p{};
    for (int i = 0; i < kLanes; ++i) {
      const glm::vec3 at = row_m_ + static_cast<float>(column_) * glm::vec3(camera_from_cell_[0]);
      p.x[i] = at.x, p.y[i] = at.y, p.z[i] = at.z;
      if (++column_ < columns_) continue;
      column_ = 0, row_m_ += glm::vec3(camera_from_cell_[1]);
    }
    return p;
  }

 private:
  glm::mat4 camera_from_cell_;
  int columns_, column_ = 0;
  glm::vec3 row_m_;
};

void find_layer(const RoomShadeParams& at, int z, const LampParams& lamp, const ShadowMap& map,
                std::span<float> out) {
  LayerPoints points(at, z);
  const VectorLanes no_normal{FloatLanes{}, FloatLanes{}, FloatLanes{}};
  for (std::size_t i = 0; i < out.size(); i += kLanes) {
    const FloatLanes seen = visibility(lamp, map, points.next(), no_normal);
    for (std::size_t k = 0; k < std::min<std::size_t>(kLanes, out.size() - i); ++k)
      out[i + k] = seen[static_cast<int>(k)];
  }
}

}  // namespace

void find_people_grid(Crew& crew, const RoomShadeParams& at, std::span<const LampParams> lamps,
                      std::span<const ShadowMap> maps, LampSet wanted, PeopleGrid& grid) {
  grid.at = at, grid.lamps = 0;
  if (at.cells.x == 0) return;
  const float cell_m = 1 / glm::length(glm::vec3(at.cell_from_camera[0]));
  const std::size_t count = std::min(lamps.size(), std::size_t{kMostLamps});
  for (std::size_t k = 0; k < count; ++k)
    if (holds(wanted, k) && lamps[k].radius_m >= kWideInCells * cell_m)
      grid.lamps |= LampSet{1} << k;
  if (grid.lamps == 0) return;
  grid.share.resize(count * std::size_t{kMostPeoplePoints});
  const std::size_t layer = grid.points() / static_cast<std::size_t>(at.cells.z);
  crew.rows(at.cells.z, 1, [&](int z, int) {
    for (std::size_t k = 0; k < count; ++k)
      if (holds(grid.lamps, k))
        find_layer(at, z, lamps[k], maps[k],
                   std::span(grid.share)
                       .subspan(k * grid.points() + static_cast<std::size_t>(z) * layer, layer));
  });
}

}  // namespace mixrig::render::cpu
