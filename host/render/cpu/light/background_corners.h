// SPDX-License-Identifier: Apache-2.0
// Pass light: surface points of the background at the corners of a tile's cells.
#pragma once

#include <algorithm>

#include "host/render/cpu/light/cells.h"

namespace mixrig::render::cpu {

/// Depth, normal and point of the background at each corner.
struct BackgroundCorners {
  CornerValues depth_m;
  alignas(64) std::array<PackedNormal, kCornersPadded> normal{};
  std::array<SurfaceLanes, kCornersPadded / kLanes> at;
};

BackgroundCorners background_corners(const LightInput& input, ImageView<const float> depth_m,
                                     const Rect& tile);

inline VectorLanes rays_at(const PinholeParams& view, FloatLanes x, FloatLanes y) {
  return {(x - view.center_px.x) / view.focal_px.x, (y - view.center_px.y) / view.focal_px.y,
          FloatLanes{} + 1.0F};
}

/// Surface point of a pixel; without depth its normal is 0, so that no lamp lights it.
inline SurfaceLanes surface_at(const VectorLanes& ray, FloatLanes depth,
                               const PackedNormal* normals) {
  const VectorLanes n = unpack(load<IntLanes>(normals), ray);
  const auto known = [&](FloatLanes f) { return depth > 0 ? f : FloatLanes{}; };
  return {{ray.x * depth, ray.y * depth, ray.z * depth}, {known(n.x), known(n.y), known(n.z)}};
}

/// kLanes pixels of a cell, in row order.
struct CellPixels {
  alignas(64) std::array<float, kLanes> depth_m, x, y;
  CellPixels(ImageView<const float> depths_m, int x0, int y0, int first) {
    for (int i = 0; i < kLanes; ++i) {
      const int px = (first + i) % kCellPx, py = (first + i) / kCellPx;
      const auto k = static_cast<std::size_t>(i);
      depth_m[k] = std::max(depths_m.row(y0 + py)[x0 + px], 0.0F);
      x[k] = static_cast<float>(x0 + px), y[k] = static_cast<float>(y0 + py);
    }
  }
  VectorLanes ray(const PinholeParams& view) const {
    return rays_at(view, load<FloatLanes>(x.data()), load<FloatLanes>(y.data()));
  }
  FloatLanes depth() const { return load<FloatLanes>(depth_m.data()); }
  /// Position of the pixels over the cell, 0..1.
  FloatLanes across(const Rect& cell) const {
    return (load<FloatLanes>(x.data()) - static_cast<float>(cell.x0)) / kCellPx;
  }
  FloatLanes down(const Rect& cell) const {
    return (load<FloatLanes>(y.data()) - static_cast<float>(cell.y0)) / kCellPx;
  }
  FloatLanes values(const Image<std::uint16_t>& image) const {
    FloatLanes out{};
    for (std::size_t i = 0; i < kLanes; ++i)
      out[static_cast<int>(i)] = image.row(static_cast<int>(y[i]))[static_cast<int>(x[i])];
    return out;
  }
  void store_light(FloatLanes ratio, Image<std::uint16_t>& light) const {
    for (std::size_t i = 0; i < kLanes; ++i)
      if (depth_m[i] > 0)
        light.row(static_cast<int>(y[i]))[static_cast<int>(x[i])] =
            light_to_fixed(ratio[static_cast<int>(i)]);
  }
};

}  // namespace mixrig::render::cpu
