// SPDX-License-Identifier: Apache-2.0
// Pass light: what the background shows at the corners of a tile's cells.
#pragma once

#include "host/render/cpu/cells.h"

namespace mixrig::render::cpu {

/// Points of the background at the corners.
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

/// No lamp lights what has no depth.
inline SurfaceLanes surface_at(const VectorLanes& ray, FloatLanes depth,
                               const PackedNormal* normals) {
  const VectorLanes n = unpack(load<IntLanes>(normals), ray);
  const auto known = [&](FloatLanes f) { return depth > 0 ? f : FloatLanes{}; };
  return {{ray.x * depth, ray.y * depth, ray.z * depth}, {known(n.x), known(n.y), known(n.z)}};
}

}  // namespace mixrig::render::cpu
