// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/light_cells.h"

#include <algorithm>
#include <array>

#include "host/render/cpu/light/background_corners.h"
#include "host/render/cpu/light/contact.h"

namespace mixrig::render::cpu {
namespace {

FloatLanes left_of(FloatLanes lost) {
  const FloatLanes one = FloatLanes{} + 1.0F;
  return lost > 0 ? max(1 - lost, FloatLanes{}) : one;
}

/// Shares of all light at the corners of a tile's cells.
struct CornerLight {
  CornerValues ratio;                               ///< light that is left
  CornerValues ambient;                             ///< taken of the ambient light
  std::array<CornerValues, kMostLamps> part, lost;  ///< of lamps in doubt, as in LightShares
};

void find_light(const LightInput& input, const Doubt& doubt, const BackgroundCorners& corners,
                CornerLight& out) {
  LightShares shares;
  for (std::size_t i = 0; i < kCornersPadded; i += kLanes) {
    shares.find(input.frame, input.maps, doubt.lamps, doubt.near, corners.at[i / kLanes]);
    FloatLanes lost = shares.ambient;
    store(&out.ambient[i], shares.ambient);
    for (std::size_t k = 0; k < input.maps.size(); ++k) {
      if (!holds(doubt.lamps, k)) continue;
      lost += shares.lost[k];
      store(&out.part[k][i], shares.part[k]), store(&out.lost[k][i], shares.lost[k]);
    }
    store(&out.ratio[i], left_of(lost));
  }
}

/// Computes cells pixel by pixel; reads the normals of a row of cells once.
class ExactCells {
 public:
  ExactCells(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m)
      : input_(input), doubt_(doubt), depth_m_(depth_m) {}
  void light(const Rect& tile, int column, int row, Image<std::uint16_t>& light);

 private:
  void read_normals(int x0, int y0);

  const LightInput& input_;
  Doubt doubt_;
  ImageView<const float> depth_m_;
  int normals_row_ = -1;
  std::array<std::array<PackedNormal, kLitTileWidth>, kCellPx> normals_;
};

void ExactCells::read_normals(int x0, int y0) {
  if (normals_row_ == y0) return;
  normals_row_ = y0;
  for (int y = 0; y < kCellPx; ++y)
    background_normals(input_, x0, y0 + y, normals_[static_cast<std::size_t>(y)], 1);
}

void ExactCells::light(const Rect& tile, int column, int row, Image<std::uint16_t>& light) {
  static_assert(kCellPx * kCellPx % kLanes == 0);
  const Rect rect = cell_rect(tile, column, row);
  const auto [near_m, far_m] = positive_range(depth_m_, rect);
  if (!(far_m > 0)) return;
  const PinholeParams& view = input_.tables.warp.view;
  const LampSet maybe =
      lamps_in_doubt(view, input_.frame.lamps, input_.maps, rect, near_m, far_m, doubt_.lamps);
  const bool near = doubt_.near && may_be_near(input_.frame, corners_of(view, rect, near_m, far_m));
  if (maybe == 0 && !near && input_.maps.size() <= kLampBits) return;
  read_normals(tile.x0, rect.y0);
  for (int first = 0; first < kCellPx * kCellPx; first += kLanes) {
    const CellPixels pixels(depth_m_, rect.x0, rect.y0, first);
    alignas(64) std::array<PackedNormal, kLanes> normals;
    for (int i = 0; i < kLanes; ++i)
      normals[static_cast<std::size_t>(i)] =
          normals_[static_cast<std::size_t>((first + i) / kCellPx)]
                  [static_cast<std::size_t>(column * kCellPx + (first + i) % kCellPx)];
    const SurfaceLanes at = surface_at(pixels.ray(view), pixels.depth(), normals.data());
    pixels.store_light(light_ratio(input_.frame, input_.maps, maybe, near, at), light);
  }
}

/// Lamps in doubt that change too much over a cell to be interpolated: the remaining ones change by
/// at most kMostChange together.
LampSet lamps_to_find(const CornerLight& light, LampSet maybe, std::size_t count, const CellOf& c) {
  LampChanges changes;
  for (std::size_t k = 0; k < count; ++k)
    if (holds(maybe, k)) changes.add(k, change_over(light.lost[k], c));
  return changes.too_large(change_over(light.ambient, c));
}

/// Computes a flat cell over which `lamps` change much.
void light_flat_cell(const LightInput& input, LampSet maybe, LampSet lamps,
                     const CornerLight& corners, ImageView<const float> depth_m, const Rect& rect,
                     const CellOf& c, Image<std::uint16_t>& light) {
  CornerValues others;
  for (const std::size_t i : {c.a, c.b, c.c, c.d}) {
    others[i] = corners.ambient[i];
    for (std::size_t k = 0; k < input.maps.size(); ++k)
      if (holds(maybe & ~lamps, k)) others[i] += corners.lost[k][i];
  }
  for (int first = 0; first < kCellPx * kCellPx; first += kLanes) {
    const CellPixels pixels(depth_m, rect.x0, rect.y0, first);
    const VectorLanes ray = pixels.ray(input.tables.warp.view);
    const FloatLanes depth = pixels.depth();
    const SurfaceLanes at{{ray.x * depth, ray.y * depth, ray.z * depth}, {}};
    const FloatLanes across = pixels.across(rect), down = pixels.down(rect);
    FloatLanes lost = between(others, c, across, down);
    for (std::size_t k = 0; k < input.maps.size(); ++k)
      if (holds(lamps, k))
        lost += hidden_of(input.frame.lamps[k], input.maps[k], at) *
                between(corners.part[k], c, across, down);
    pixels.store_light(left_of(lost), light);
  }
}

}  // namespace

BackgroundCorners background_corners(const LightInput& input, ImageView<const float> depth_m,
                                     const Rect& tile) {
  BackgroundCorners out;
  out.depth_m.fill(0);
  each_corner(tile, depth_m.size,
              [&](std::size_t i, int x, int y) { out.depth_m[i] = depth_m.row(y)[x]; });
  const bool cut = tile.x0 + kCellsAcross * kCellPx >= depth_m.size.width;
  for (int row = 0; row <= kCellsDown; ++row) {
    const std::span to(&out.normal[corner(0, row)], static_cast<std::size_t>(kCellsAcross + 1));
    const int y = std::min(tile.y0 + row * kCellPx, depth_m.size.height - 1);
    background_normals(input, tile.x0, y, to.first(cut ? kCellsAcross : kCellsAcross + 1), kCellPx);
    if (cut) to.back() = to[kCellsAcross - 1];
  }
  CornerValues px, py;
  px.fill(0), py.fill(0);
  each_corner(tile, depth_m.size, [&](std::size_t i, int x, int y) {
    px[i] = static_cast<float>(x), py[i] = static_cast<float>(y);
  });
  for (std::size_t i = 0; i < kCornersPadded; i += kLanes)
    out.at[i / kLanes] = surface_at(
        rays_at(input.tables.warp.view, load<FloatLanes>(&px[i]), load<FloatLanes>(&py[i])),
        max(load<FloatLanes>(&out.depth_m[i]), FloatLanes{}), &out.normal[i]);
  return out;
}

bool blur_allows_cells(const PinholeParams& view, const std::vector<LampParams>& lamps,
                       const std::vector<ShadowMap>& maps, LampSet maybe, const Rect& tile,
                       float near_m, float far_m) {
  const float cell_m = kCellPx * far_m / std::min(view.focal_px.x, view.focal_px.y);
  const glm::vec3 at_m = near_m * ray_of(view, (tile.x0 + tile.x1) / 2, (tile.y0 + tile.y1) / 2);
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = lamps[k];
    if (!holds(maybe, k) || maps[k].empty()) continue;
    // Radius on the surface within which casters are searched (docs/method/compositor.md, light).
    const float depth_m = transform(lamp.lamp_from_camera, at_m).z;
    if (!(lamp.radius_m * (depth_m / lamp.casters_near_m - 1) >= cell_m)) return false;
  }
  return true;
}

void light_exactly(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m,
                   const Rect& tile, Image<std::uint16_t>& light) {
  ExactCells exact(input, doubt, depth_m);
  each_cell([&](int column, int row) { exact.light(tile, column, row, light); });
}

void light_in_cells(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m,
                    const Rect& tile, Image<std::uint16_t>& light) {
  const BackgroundCorners corners = background_corners(input, depth_m, tile);
  CornerLight found;
  find_light(input, doubt, corners, found);
  ExactCells exact(input, doubt, depth_m);
  // Panels are split into parts where light is computed once and may take longer.
  const std::vector<LampParams>& lamps = input.frame.lamps;
  const bool once =
      std::any_of(lamps.begin(), lamps.end(), [](auto& lamp) { return lamp.is_part; });
  each_cell([&](int column, int row) {
    const CellOf c = cell(column, row);
    const Rect rect = cell_rect(tile, column, row);
    if (!is_flat(depth_m.row(rect.y0) + rect.x0, depth_m.stride, corners.depth_m, c) ||
        change_over(found.ambient, c) > kMostChange)
      return exact.light(tile, column, row, light);
    if (change_over(found.ratio, c) > kMostChange) {
      if (once) return exact.light(tile, column, row, light);
      const LampSet to_find = lamps_to_find(found, doubt.lamps, input.maps.size(), c);
      return light_flat_cell(input, doubt.lamps, to_find, found, depth_m, rect, c, light);
    }
    const CornerValues& ratio = found.ratio;
    if (!(std::min({ratio[c.a], ratio[c.b], ratio[c.c], ratio[c.d]}) < 1)) return;
    between(ratio, c, [&](int x, int y, float value) {
      light.row(rect.y0 + y)[rect.x0 + x] = light_to_fixed(value);
    });
  });
}

}  // namespace mixrig::render::cpu
