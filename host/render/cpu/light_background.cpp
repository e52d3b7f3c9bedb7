// SPDX-License-Identifier: Apache-2.0
// Pass light: how much light the empty room keeps, and the room past people.
#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "host/render/cpu/light_parts.h"

namespace mixrig::render::cpu {
namespace {

/// Of the background in a row of a tile.
void background_normals(const LightInput& input, int x0, int y, std::span<PackedNormal> out) {
  if (input.moving) return input.moving->normals(x0, y, out);
  std::copy_n(input.tables.background_normal.row(y) + x0, out.size(), out.begin());
}

/// Depths that light falls on.
ImageView<const float> lit_depth_m(const LightInput& input) {
  return input.moving || input.tables.light_depth_m.empty() ? input.background.depth_m
                                                            : input.tables.light_depth_m.view();
}

/// As ray_of and unpack.
VectorLanes rays_of(const PinholeParams& view, int x, int y) {
  const FloatLanes u = lane_numbers() + static_cast<float>(x);
  return {(u - view.center_px.x) / view.focal_px.x,
          FloatLanes{} + (static_cast<float>(y) - view.center_px.y) / view.focal_px.y,
          FloatLanes{} + 1.0F};
}
VectorLanes unpack(IntLanes packed, const VectorLanes& ray) {
  static_assert(sizeof(PackedNormal) == sizeof(std::int32_t));
  const auto byte = [&](int shift) { return to_float((packed << (24 - shift)) >> 24); };
  const IntLanes none = (packed & 0xFFFFFF) == 0;
  const auto of = [&](FloatLanes n, FloatLanes r) { return none ? -r : n; };
  const VectorLanes n{of(byte(0), ray.x), of(byte(8), ray.y), of(byte(16), ray.z)};
  const FloatLanes scale = 1 / sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  return {n.x * scale, n.y * scale, n.z * scale};
}

/// A row of a tile, from out[0] on; precondition: at least one pixel.
void light_row(const LightInput& input, LampSet maybe, int y, int x0, int x1, std::uint16_t* out,
               const PeopleMaps* people = nullptr) {
  const float* depth_m = lit_depth_m(input).row(y);
  std::array<PackedNormal, kLitTileWidth> normals{};
  background_normals(input, x0, y, std::span(normals).first(static_cast<std::size_t>(x1 - x0)));
  for (int x = x0; x < x1; x += kLanes) {
    const FloatLanes depth = max(float_lanes(depth_m, x, x1), FloatLanes{});
    const VectorLanes ray = rays_of(input.tables.warp.view, x, y);
    const SurfaceLanes at{{ray.x * depth, ray.y * depth, ray.z * depth},
                          unpack(load<IntLanes>(normals.data() + (x - x0)), ray)};
    const FloatLanes ratio = light_ratio(input.frame, input.maps, maybe, at, people);
    for (int i = 0; i < std::min(kLanes, x1 - x); ++i)
      out[x - x0 + i] = depth[i] > 0 ? light_to_fixed(ratio[i]) : kLit;
  }
}

void light_tile(const LightInput& input, const Rect& rect, Image<std::uint16_t>& light) {
  for (int y = rect.y0; y < rect.y1; ++y)
    std::fill(light.row(y) + rect.x0, light.row(y) + rect.x1, kLit);
  const auto [near_m, far_m] = positive_range(lit_depth_m(input), rect);
  if (!(far_m > 0)) return;
  const LampSet maybe =
      lamps_in_doubt(input.tables.warp.view, input.frame.lamps, input.maps, rect, near_m, far_m);
  if (maybe == 0 && input.maps.size() <= kLampBits) return;
  for (int y = rect.y0; y < rect.y1; ++y)
    light_row(input, maybe, y, rect.x0, rect.x1, light.row(y) + rect.x0);
}

/// A tile of the background that an object shades, past people.
void light_tile_past_people(const LightInput& input, const Rect& rect, LightLayer& light) {
  bool in_shadow = false;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) in_shadow |= light.background.row(y)[x] < kLit;
  if (!in_shadow) return;
  const auto [near_m, far_m] = positive_range(lit_depth_m(input), rect);
  if (!(far_m > 0)) return;
  const PinholeParams& view = input.tables.warp.view;
  const PeopleMaps people{
      input.people->lamps, input.people->maps,
      lamps_in_doubt(view, input.people->lamps, input.people->maps, rect, near_m, far_m)};
  if (people.maybe == 0) return;
  const LampSet maybe = lamps_in_doubt(view, input.frame.lamps, input.maps, rect, near_m, far_m);
  for (int y = rect.y0; y < rect.y1; ++y)
    light_row(input, maybe, y, rect.x0, rect.x1, light.visible.row(y) + rect.x0, &people);
}

}  // namespace

std::pair<float, float> positive_range(ImageView<const float> image, const Rect& rect) {
  constexpr float kMost = std::numeric_limits<float>::max();
  float least = kMost, largest = 0;
  for (int y = rect.y0; y < rect.y1; ++y) {
    const float* row = image.row(y);
#pragma omp simd reduction(min : least) reduction(max : largest)
    for (int x = rect.x0; x < rect.x1; ++x) {
      least = std::min(least, row[x] > 0 ? row[x] : kMost);
      largest = std::max(largest, row[x]);
    }
  }
  return {largest > 0 ? least : 0, largest};
}

LampSet lamps_in_doubt(const PinholeParams& view, const std::vector<LampParams>& lamps,
                       const std::vector<ShadowMap>& maps, const Rect& rect, float near_m,
                       float far_m) {
  Corners corners_m;
  for (std::size_t i = 0; i < 8; ++i)
    corners_m[i] = ray_of(view, i & 1 ? rect.x1 - 1 : rect.x0, i & 2 ? rect.y1 - 1 : rect.y0) *
                   (i & 4 ? far_m : near_m);
  LampSet set = 0;
  for (std::size_t k = 0; k < std::min(maps.size(), kLampBits); ++k)
    set |= LampSet{may_be_shadowed(lamps[k], maps[k], corners_m)} << k;
  return set;
}

bool has_shadows(const FrameParams& frame) {
  return std::any_of(frame.lamps.begin(), frame.lamps.end(),
                     [](const LampParams& lamp) { return lamp.map_size_texel > 0; });
}

void light_background(Crew& crew, const LightInput& input, LightLayer& light) {
  Image<std::uint16_t>& out = light.background;
  if (input.background.depth_m.empty()) return out.fill(kLit);
  crew.rows(out.height(), kLitTileHeight, [&](int begin, int end) {
    for (int x = 0; x < out.width(); x += kLitTileWidth)
      light_tile(input, {x, begin, std::min(x + kLitTileWidth, out.width()), end}, out);
  });
}

void light_visible_background(Crew& crew, const LightInput& input, LightLayer& light) {
  const Size size = light.background.size();
  const bool past_people = input.people != nullptr && !input.background.depth_m.empty();
  crew.rows(size.height, kLitTileHeight, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      std::copy_n(light.background.row(y), size.width, light.visible.row(y));
    for (int x = 0; past_people && x < size.width; x += kLitTileWidth)
      light_tile_past_people(input, {x, begin, std::min(x + kLitTileWidth, size.width), end},
                             light);
  });
}

}  // namespace mixrig::render::cpu
