// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/virtual_cells.h"

#include <algorithm>
#include <array>

namespace mixrig::render::cpu {
namespace {

/// Least cosine between unit normals at the corners of a smooth cell.
constexpr float kLeastCosine = 0.9F;
constexpr float kFaintestAmbient = 1e-12F;

}  // namespace

VirtualCorners::VirtualCorners(const PinholeParams& view, const Rect& tile,
                               const VirtualLayer& layer) {
  CornerValues w;
  std::array<glm::vec3, kCornersPadded> normal;
  std::array<bool, kCornersPadded> covered{};
  w.fill(1), normal.fill({0, 0, -1});
  for (std::size_t i = 0; i < kCornersPadded; ++i)
    at_[i / kLanes].set(static_cast<int>(i % kLanes), {0, 0, 1}, glm::vec3(0));
  each_corner(tile, layer.w.size(), [&](std::size_t i, int x, int y) {
    covered[i] = layer.coverage.row(y)[x] == 255;
    if (!covered[i]) return;
    const glm::vec3 ray = ray_of(view, x, y);
    w[i] = layer.w.row(y)[x], normal[i] = unpack(layer.normal.row(y)[x], ray);
    at_[i / kLanes].set(static_cast<int>(i % kLanes), ray / w[i], normal[i]);
  });
  each_cell([&](int column, int row) {
    const CellOf c = cell(column, row);
    const int x0 = tile.x0 + column * kCellPx, y0 = tile.y0 + row * kCellPx;
    if (x0 + kCellPx > tile.x1 || y0 + kCellPx > tile.y1) return;
    if (!(covered[c.a] && covered[c.b] && covered[c.c] && covered[c.d])) return;
    const auto alike = [&](std::size_t i, std::size_t j) {
      return glm::dot(normal[i], normal[j]) >= kLeastCosine;
    };
    if (alike(c.a, c.d) && alike(c.b, c.c) && alike(c.a, c.b) && alike(c.a, c.c) &&
        is_flat(layer.w.row(y0) + x0, layer.w.stride(), w, c))
      smooth_ |= bit(column, row);
  });
}

VirtualCells::VirtualCells(const LightInput& input, LampSet maybe, const Rect& tile,
                           const VirtualLayer& layer)
    : tile_(tile),
      corners_(input.tables.warp.view, tile, layer),
      maybe_(maybe),
      count_(std::min(input.maps.size(), seen_.size())) {
  if (corners_.any_smooth()) find_shares(input, maybe);
}

void VirtualCells::find_shares(const LightInput& input, LampSet maybe) {
  const std::vector<LampParams>& lamps = input.frame.lamps;
  for (std::size_t i = 0; i < VirtualCorners::kRegisters; ++i) {
    const std::size_t at = i * kLanes;
    std::array<FloatLanes, kMostLamps> light;
    const SurfaceLanes& surface = corners_.at()[i];
    FloatLanes all =
        FloatLanes{} + std::max(luminance(input.frame.light.ambient), kFaintestAmbient);
    for (std::size_t k = 0; k < count_; ++k) all += light[k] = lamp_light(lamps[k], surface);
    FloatLanes room = FloatLanes{} + 1.0F;
    for (std::size_t k = 0; k < count_; ++k) {
      // Parts of a panel share their visibility past the room.
      if (k == 0 || lamps[k].room_layer != lamps[k - 1].room_layer)
        room = room_share(input.frame, lamps[k], surface);
      store(&in_room_[k][at], room);
      if (!holds(maybe, k)) continue;
      store(&weight_[k][at], light[k] / all);
      const bool lit = any(light[k] > 0);
      const VectorLanes& n = surface.normal;
      const IntLanes covered = (n.x != 0) | (n.y != 0) | (n.z != 0);
      store(&seen_[k][at], lit ? room * visibility_of_caster(lamps[k], input.maps[k],
                                                             surface.position_m, n, covered)
                               : room);
    }
  }
}

LampSet VirtualCells::lamps_to_find(int column, int row) const {
  const CellOf c = cell(column, row);
  LampChanges changes;
  for (std::size_t k = 0; k < count_; ++k) {
    if (!holds(maybe_, k)) continue;
    const CornerValues& weight = weight_[k];
    const float most = std::max({weight[c.a], weight[c.b], weight[c.c], weight[c.d]});
    changes.add(k, change_over(seen_[k], c) * most);
  }
  return changes.too_large();
}

void VirtualCells::shares(int column, int row, LampSet to_find, FloatLanes x, FloatLanes y,
                          std::span<FloatLanes> out) const {
  const CellOf c = cell(column, row);
  const Rect rect = cell_rect(tile_, column, row);
  const FloatLanes across = (x - static_cast<float>(rect.x0)) / kCellPx;
  const FloatLanes down = (y - static_cast<float>(rect.y0)) / kCellPx;
  for (std::size_t k = 0; k < count_; ++k)
    out[k] = between(holds(maybe_ & ~to_find, k) ? seen_[k] : in_room_[k], c, across, down);
}

}  // namespace mixrig::render::cpu
