// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace mixrig::render::cpu {
namespace {

/// By which a depth within a cell may differ from the plane through its corners.
constexpr float kFlatPart = 0.01F;
/// Of unit normals at the corners of a cell of a virtual surface.
constexpr float kLeastCosine = 0.9F;
constexpr float kFaintestLight = 1e-12F;

/// Number of a corner.
constexpr std::size_t corner(int column, int row) {
  return static_cast<std::size_t>(row * kCellsAcross + row + column);
}

/// The corners of a cell, from its upper left one.
struct CellOf {
  std::size_t a, b, c, d;
};
constexpr CellOf cell(int column, int row) {
  return {corner(column, row), corner(column + 1, row), corner(column, row + 1),
          corner(column + 1, row + 1)};
}

/// Whether values times `weight` do.
bool changes_little(const CornerValues& v, const CellOf& c, float weight) {
  const auto [least, most] = std::minmax({v[c.a], v[c.b], v[c.c], v[c.d]});
  return (most - least) * weight <= kMostChange;
}

/// Between the corners of a cell, at each of its pixels: `visit(x, y, value)`.
template <typename Visit>
void between(const CornerValues& v, const CellOf& c, Visit&& visit) {
  for (int y = 0; y < kCellPx; ++y) {
    const float down = static_cast<float>(y) / kCellPx;
    const float left = v[c.a] + (v[c.c] - v[c.a]) * down;
    const float step = (v[c.b] + (v[c.d] - v[c.b]) * down - left) / kCellPx;
    for (int x = 0; x < kCellPx; ++x) visit(x, y, left + step * static_cast<float>(x));
  }
}

/// Whether the values of a cell's pixels, the first at `from`, lie on the plane of its corners.
bool is_flat(const float* from, std::ptrdiff_t stride, const CornerValues& v, const CellOf& c) {
  if (!(v[c.a] > 0 && v[c.b] > 0 && v[c.c] > 0 && v[c.d] > 0)) return false;
  bool flat = true;
  between(v, c, [&](int x, int y, float value) {
    flat &= std::abs(from[y * stride + x] - value) <= kFlatPart * value;
  });
  return flat;
}

/// Calls visit(column, row) for each cell of a tile.
template <typename Visit>
void each_cell(Visit&& visit) {
  for (int row = 0; row < kCellsDown; ++row)
    for (int column = 0; column < kCellsAcross; ++column) visit(column, row);
}

/// Calls visit(number, x, y) for each corner, within the view.
template <typename Visit>
void each_corner(const Rect& tile, Size view, Visit&& visit) {
  for (int row = 0; row <= kCellsDown; ++row)
    for (int column = 0; column <= kCellsAcross; ++column)
      visit(corner(column, row), std::min(tile.x0 + column * kCellPx, view.width - 1),
            std::min(tile.y0 + row * kCellPx, view.height - 1));
}

/// Points of the background at the corners.
struct BackgroundCorners {
  CornerValues depth_m;
  alignas(64) std::array<PackedNormal, kCornersPadded> normal{};
};

BackgroundCorners background_corners(const LightInput& input, ImageView<const float> depth_m,
                                     const Rect& tile) {
  BackgroundCorners out;
  out.depth_m.fill(1);
  each_corner(tile, depth_m.size,
              [&](std::size_t i, int x, int y) { out.depth_m[i] = depth_m.row(y)[x]; });
  const bool cut = tile.x0 + kCellsAcross * kCellPx >= depth_m.size.width;
  for (int row = 0; row <= kCellsDown; ++row) {
    const std::span to(&out.normal[corner(0, row)], static_cast<std::size_t>(kCellsAcross + 1));
    const int y = std::min(tile.y0 + row * kCellPx, depth_m.size.height - 1);
    background_normals(input, tile.x0, y, to.first(cut ? kCellsAcross : kCellsAcross + 1), kCellPx);
    if (cut) to.back() = to[kCellsAcross - 1];
  }
  return out;
}

/// Light of a register of background points.
FloatLanes ratio_of(const LightInput& input, const Doubt& doubt, const VectorLanes& ray,
                    FloatLanes depth, const PackedNormal* normals) {
  const SurfaceLanes at{{ray.x * depth, ray.y * depth, ray.z * depth},
                        unpack(load<IntLanes>(normals), ray)};
  return light_ratio(input.frame, input.maps, doubt.lamps, doubt.near, at);
}

VectorLanes rays_at(const PinholeParams& view, FloatLanes x, FloatLanes y) {
  return {(x - view.center_px.x) / view.focal_px.x, (y - view.center_px.y) / view.focal_px.y,
          FloatLanes{} + 1.0F};
}

/// Light at the corners; 1 where the depth is not known.
void find_ratios(const LightInput& input, const Doubt& doubt, const Rect& tile,
                 const BackgroundCorners& corners, Size view, CornerValues& ratio) {
  CornerValues x, y;
  x.fill(0), y.fill(0);
  each_corner(tile, view, [&](std::size_t i, int px, int py) {
    x[i] = static_cast<float>(px), y[i] = static_cast<float>(py);
  });
  for (std::size_t i = 0; i < kCornersPadded; i += kLanes) {
    const VectorLanes ray =
        rays_at(input.tables.warp.view, load<FloatLanes>(&x[i]), load<FloatLanes>(&y[i]));
    const FloatLanes depth = max(load<FloatLanes>(&corners.depth_m[i]), FloatLanes{});
    store(&ratio[i], ratio_of(input, doubt, ray, depth, &corners.normal[i]));
  }
}

/// Each pixel of cells by itself; the normals of a row of cells are read once.
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
  const int left = column * kCellPx, x0 = tile.x0 + left, y0 = tile.y0 + row * kCellPx;
  read_normals(tile.x0, y0);
  for (int first = 0; first < kCellPx * kCellPx; first += kLanes) {
    alignas(64) std::array<float, kLanes> depth_m, x, y;
    alignas(64) std::array<PackedNormal, kLanes> normals;
    for (int i = 0; i < kLanes; ++i) {
      const int px = (first + i) % kCellPx, py = (first + i) / kCellPx;
      const auto k = static_cast<std::size_t>(i);
      depth_m[k] = std::max(depth_m_.row(y0 + py)[x0 + px], 0.0F);
      normals[k] = normals_[static_cast<std::size_t>(py)][static_cast<std::size_t>(left + px)];
      x[k] = static_cast<float>(x0 + px), y[k] = static_cast<float>(y0 + py);
    }
    const FloatLanes depth = load<FloatLanes>(depth_m.data());
    const VectorLanes ray =
        rays_at(input_.tables.warp.view, load<FloatLanes>(x.data()), load<FloatLanes>(y.data()));
    const FloatLanes ratio = ratio_of(input_, doubt_, ray, depth, normals.data());
    for (int i = 0; i < kLanes; ++i)
      if (depth[i] > 0)
        light.row(y0 + (first + i) / kCellPx)[x0 + (first + i) % kCellPx] =
            light_to_fixed(ratio[i]);
  }
}

}  // namespace

bool blur_allows_cells(const LightInput& input, LampSet maybe, const Rect& tile, float near_m,
                       float far_m) {
  const PinholeParams& view = input.tables.warp.view;
  const float cell_m = kCellPx * far_m / std::min(view.focal_px.x, view.focal_px.y);
  const glm::vec3 at_m = near_m * ray_of(view, (tile.x0 + tile.x1) / 2, (tile.y0 + tile.y1) / 2);
  for (std::size_t k = 0; k < input.maps.size(); ++k) {
    const LampParams& lamp = input.frame.lamps[k];
    if (!holds(maybe, k) || input.maps[k].empty()) continue;
    // Casters are searched within so much of a surface (README.md, light).
    const float depth_m = transform(lamp.lamp_from_camera, at_m).z;
    if (!(lamp.radius_m * (depth_m / lamp.casters_near_m - 1) >= cell_m)) return false;
  }
  return true;
}

void light_in_cells(const LightInput& input, const Doubt& doubt, ImageView<const float> depth_m,
                    const Rect& tile, Image<std::uint16_t>& light) {
  const BackgroundCorners corners = background_corners(input, depth_m, tile);
  CornerValues ratio;
  find_ratios(input, doubt, tile, corners, depth_m.size, ratio);
  ExactCells exact(input, doubt, depth_m);
  each_cell([&](int column, int row) {
    const CellOf c = cell(column, row);
    const int x0 = tile.x0 + column * kCellPx, y0 = tile.y0 + row * kCellPx;
    if (!changes_little(ratio, c, 1) ||
        !is_flat(depth_m.row(y0) + x0, depth_m.stride, corners.depth_m, c)) {
      return exact.light(tile, column, row, light);
    }
    if (!(std::min({ratio[c.a], ratio[c.b], ratio[c.c], ratio[c.d]}) < 1)) return;
    between(ratio, c,
            [&](int x, int y, float value) { light.row(y0 + y)[x0 + x] = light_to_fixed(value); });
  });
}

VirtualCells::VirtualCells(const LightInput& input, LampSet maybe, const Rect& tile,
                           const VirtualLayer& layer)
    : tile_(tile) {
  find_flat(input, layer);
  if (smooth_ != 0) find_shares(input, maybe);
}

/// Cells that show one smooth surface.
void VirtualCells::find_flat(const LightInput& input, const VirtualLayer& layer) {
  CornerValues w;
  std::array<glm::vec3, kCornersPadded> normal;
  std::array<bool, kCornersPadded> covered{};
  w.fill(1), normal.fill({0, 0, -1});
  for (std::size_t i = 0; i < kCornersPadded; ++i)
    at_[i / kLanes].set(static_cast<int>(i % kLanes), {0, 0, 1}, normal[i]);
  each_corner(tile_, layer.w.size(), [&](std::size_t i, int x, int y) {
    covered[i] = layer.coverage.row(y)[x] == 255;
    if (!covered[i]) return;
    const glm::vec3 ray = ray_of(input.tables.warp.view, x, y);
    w[i] = layer.w.row(y)[x], normal[i] = unpack(layer.normal.row(y)[x], ray);
    at_[i / kLanes].set(static_cast<int>(i % kLanes), ray / w[i], normal[i]);
  });
  each_cell([&](int column, int row) {
    const CellOf c = cell(column, row);
    const int x0 = tile_.x0 + column * kCellPx, y0 = tile_.y0 + row * kCellPx;
    if (x0 + kCellPx > tile_.x1 || y0 + kCellPx > tile_.y1) return;
    if (!(covered[c.a] && covered[c.b] && covered[c.c] && covered[c.d])) return;
    const auto alike = [&](std::size_t i, std::size_t j) {
      return glm::dot(normal[i], normal[j]) >= kLeastCosine;
    };
    if (alike(c.a, c.d) && alike(c.b, c.c) && alike(c.a, c.b) && alike(c.a, c.c) &&
        is_flat(layer.w.row(y0) + x0, layer.w.stride(), w, c))
      smooth_ |= bit(column, row);
  });
}

/// Of each lamp in doubt; what changes the light much over a cell is not smooth.
void VirtualCells::find_shares(const LightInput& input, LampSet maybe) {
  const std::vector<LampParams>& lamps = input.frame.lamps;
  std::array<FloatLanes, kRegisters> all;
  all.fill(FloatLanes{} + std::max(luminance(input.frame.light.ambient), kFaintestLight));
  for (std::size_t i = 0; i < kRegisters; ++i)
    for (const LampParams& lamp : lamps) all[i] += lamp_light(lamp, at_[i]);
  for (std::size_t k = 0; k < std::min(input.maps.size(), shares_.size()); ++k) {
    if (!holds(maybe, k)) continue;
    CornerValues weight;
    for (std::size_t i = 0; i < kRegisters; ++i) {
      const FloatLanes light = lamp_light(lamps[k], at_[i]);
      store(&weight[i * kLanes], light / all[i]);
      store(&shares_[k][i * kLanes],
            any(light > 0) ? visibility(lamps[k], input.maps[k], at_[i].position_m, at_[i].normal)
                           : FloatLanes{} + 1.0F);
    }
    each_cell([&](int column, int row) {
      const CellOf c = cell(column, row);
      const float most = std::max({weight[c.a], weight[c.b], weight[c.c], weight[c.d]});
      if (!changes_little(shares_[k], c, most)) smooth_ &= ~bit(column, row);
    });
  }
}

FloatLanes VirtualCells::share(std::size_t lamp, FloatLanes x, FloatLanes y) const {
  const FloatLanes across = (x - static_cast<float>(tile_.x0)) / kCellPx;
  const FloatLanes down = (y - static_cast<float>(tile_.y0)) / kCellPx;
  const IntLanes column = truncate(across), row = truncate(down);
  const FloatLanes u = across - to_float(column), v = down - to_float(row);
  const IntLanes first = row * (kCellsAcross + 1) + column;
  const float* from = shares_[lamp].data();
  const auto along = [&](int offset) {
    const FloatLanes a = gather(from, first + offset), b = gather(from, first + (offset + 1));
    return a + (b - a) * u;
  };
  const FloatLanes top = along(0), low = along(kCellsAcross + 1);
  return top + (low - top) * v;
}

}  // namespace mixrig::render::cpu
