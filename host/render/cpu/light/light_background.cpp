// SPDX-License-Identifier: Apache-2.0
// Pass light: light of the empty room, and of the room past people.
#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <tuple>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/light/contact.h"
#include "host/render/cpu/light/light_cells.h"
#include "host/render/cpu/light/light_parts.h"
#include "host/render/cpu/light/people_cells.h"

namespace mixrig::render::cpu {
namespace {

/// Tiles of a row that are tested together for shadows at first.
constexpr int kTilesTogether = 8;

/// Depth of the background as used for light.
ImageView<const float> lit_depth_m(const LightInput& input) {
  if (input.moving) return input.moving->light_depth_m();
  return input.tables.light_depth_m.empty() ? input.background.depth_m
                                            : input.tables.light_depth_m.view();
}

/// Rays of kLanes pixels from (x, y) on, as ray_of().
VectorLanes rays_of(const PinholeParams& view, int x, int y) {
  const FloatLanes u = lane_numbers() + static_cast<float>(x);
  return {(u - view.center_px.x) / view.focal_px.x,
          FloatLanes{} + (static_cast<float>(y) - view.center_px.y) / view.focal_px.y,
          FloatLanes{} + 1.0F};
}

/// Computes light of a tile's row of at least one pixel, into out[0] and on. Pixels of which
/// `people` hide nothing keep their value.
void light_row(const LightInput& input, const Doubt& doubt, int y, int x0, int x1,
               std::uint16_t* out, const PeopleMaps* people = nullptr) {
  const float* depth_m = lit_depth_m(input).row(y);
  std::array<PackedNormal, kLitTileWidth> normals{};
  background_normals(input, x0, y, std::span(normals).first(static_cast<std::size_t>(x1 - x0)), 1);
  for (int x = x0; x < x1; x += kLanes) {
    const FloatLanes depth = max(float_lanes(depth_m, x, x1), FloatLanes{});
    const VectorLanes ray = rays_of(input.tables.warp.view, x, y);
    const SurfaceLanes at{{ray.x * depth, ray.y * depth, ray.z * depth},
                          unpack(load<IntLanes>(normals.data() + (x - x0)), ray)};
    FloatLanes ratio;
    if (people == nullptr)
      ratio = light_ratio(input.frame, input.maps, doubt.lamps, doubt.near, at);
    else if (!light_ratio_past_people(input.frame, input.maps, doubt.lamps, doubt.near, *people, at,
                                      ratio))
      continue;
    for (int i = 0; i < std::min(kLanes, x1 - x); ++i)
      out[x - x0 + i] = depth[i] > 0 ? light_to_fixed(ratio[i]) : kLit;
  }
}

/// Least and largest depth of a rectangle; 0 if none is known.
using DepthRange = std::pair<float, float>;

/// What objects may hide from the background in a rectangle. `among`: the result for a larger
/// rectangle around it.
Doubt doubt_of(const LightInput& input, const Rect& rect, const DepthRange& depth_m,
               const Doubt& among = {}) {
  if (!(depth_m.second > 0)) return {0, false};
  const PinholeParams& view = input.tables.warp.view;
  const auto [near_m, far_m] = depth_m;
  return {lamps_in_doubt(view, input.frame.lamps, input.maps, rect, near_m, far_m, among.lamps),
          among.near && may_be_near(input.frame, corners_of(view, rect, near_m, far_m))};
}

bool is_sure(const LightInput& input, const Doubt& doubt) {
  return doubt.lamps == 0 && !doubt.near && input.maps.size() <= kLampBits;
}

/// Computes the light of a tile. `among`: what is in doubt around it.
void light_tile(const LightInput& input, const Doubt& among, const Rect& rect,
                const DepthRange& depth_m, Image<std::uint16_t>& light) {
  if (!(depth_m.second > 0)) return;
  const Doubt doubt = doubt_of(input, rect, depth_m, among);
  if (is_sure(input, doubt)) return;
  if (rect.x1 - rect.x0 == kLitTileWidth && rect.y1 - rect.y0 == kLitTileHeight) {
    const bool wide = input.maps.size() <= kMostLamps &&
                      blur_allows_cells(input.tables.warp.view, input.frame.lamps, input.maps,
                                        doubt.lamps, rect, depth_m.first, depth_m.second);
    return (wide ? light_in_cells : light_exactly)(input, doubt, lit_depth_m(input), rect, light);
  }
  for (int y = rect.y0; y < rect.y1; ++y)
    light_row(input, doubt, y, rect.x0, rect.x1, light.row(y) + rect.x0);
}

/// Computes a row of tiles, testing what they all show first.
void light_tiles(const LightInput& input, const Rect& rect, Image<std::uint16_t>& light) {
  for (int y = rect.y0; y < rect.y1; ++y)
    std::fill(light.row(y) + rect.x0, light.row(y) + rect.x1, kLit);
  std::array<DepthRange, kTilesTogether> depth_m;
  DepthRange all{0, 0};
  const auto tile = [&](int i) {
    const int x0 = rect.x0 + i * kLitTileWidth;
    return Rect{x0, rect.y0, std::min(x0 + kLitTileWidth, rect.x1), rect.y1};
  };
  const int count = (rect.x1 - rect.x0 + kLitTileWidth - 1) / kLitTileWidth;
  for (int i = 0; i < count; ++i) {
    const DepthRange range = positive_range(lit_depth_m(input), tile(i));
    depth_m[static_cast<std::size_t>(i)] = range;
    if (!(range.second > 0)) continue;
    all.first = all.second > 0 ? std::min(all.first, range.first) : range.first;
    all.second = std::max(all.second, range.second);
  }
  const Doubt doubt = doubt_of(input, rect, all);
  if (is_sure(input, doubt)) return;
  for (int i = 0; i < count; ++i)
    light_tile(input, doubt, tile(i), depth_m[static_cast<std::size_t>(i)], light);
}

/// Finds what does not depend on people in a tile.
void look_at(const LightInput& input, const Rect& rect, const LightLayer& light,
             BackgroundTile& tile) {
  tile = {.seen = true};
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) tile.in_shadow |= light.background.row(y)[x] < kLit;
  if (!tile.in_shadow) return;
  std::tie(tile.near_m, tile.far_m) = positive_range(lit_depth_m(input), rect);
}

/// Computes, past people, the light of background tile `number`, which an object shades.
void light_tile_past_people(const LightInput& input, const Rect& rect, std::size_t number,
                            LightLayer& light) {
  BackgroundTile& tile = light.room_tiles[number];
  if (!tile.seen) look_at(input, rect, light, tile);
  if (!tile.in_shadow || !(tile.far_m > 0)) return;
  const PinholeParams& view = input.tables.warp.view;
  const PeopleShadow& shadow = *input.people;
  const PeopleMaps people{
      shadow.lamps, shadow.maps, shadow.grid,
      lamps_in_doubt(view, shadow.lamps, shadow.maps, rect, tile.near_m, tile.far_m, shadow.reach)};
  if (people.maybe == 0) return;
  const Doubt doubt = doubt_of(input, rect, {tile.near_m, tile.far_m});
  const bool whole = rect.x1 - rect.x0 == kLitTileWidth && rect.y1 - rect.y0 == kLitTileHeight;
  if (whole && std::max(input.maps.size(), people.maps.size()) <= kMostLamps &&
      people_allow_cells(view, people, rect, tile.near_m, tile.far_m))
    return light_cells_past_people(input, doubt, people, lit_depth_m(input), rect, tile,
                                   light.corners.row(static_cast<int>(number)), light);
  for (int y = rect.y0; y < rect.y1; ++y)
    light_row(input, doubt, y, rect.x0, rect.x1, light.visible.row(y) + rect.x0, &people);
}

int tiles_across(Size view) { return (view.width + kLitTileWidth - 1) / kLitTileWidth; }

}  // namespace

void background_normals(const LightInput& input, int x0, int y, std::span<PackedNormal> out,
                        int step) {
  if (input.moving) return input.moving->normals(x0, y, out, step);
  const PackedNormal* from = input.tables.background_normal.row(y) + x0;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = from[i * static_cast<std::size_t>(step)];
}

std::pair<float, float> positive_range(ImageView<const float> image, const Rect& rect) {
  const FloatLanes none = FloatLanes{} + std::numeric_limits<float>::max();
  FloatLanes least = none, largest{};
  for (int x = rect.x0; x < rect.x1; x += kLanes)
    for (int y = rect.y0; y < rect.y1; ++y) {
      const FloatLanes v = float_lanes(image.row(y), x, rect.x1);
      least = min(least, v > 0 ? v : none), largest = max(largest, v);
    }
  float low = least[0], high = largest[0];
  for (int i = 1; i < kLanes; ++i) low = std::min(low, least[i]), high = std::max(high, largest[i]);
  return {high > 0 ? low : 0, high};
}

Corners corners_of(const PinholeParams& view, const Rect& rect, float near_m, float far_m) {
  const glm::vec3 first = ray_of(view, rect.x0, rect.y0),
                  last = ray_of(view, rect.x1 - 1, rect.y1 - 1);
  const F4 x{first.x, last.x, first.x, last.x}, y{first.y, first.y, last.y, last.y};
  const auto face = [&](float z_m) { return Corners::Face{x * z_m, y * z_m, F4{} + z_m}; };
  return {{face(near_m), face(far_m)}};
}

LampSet lamps_in_doubt(const PinholeParams& view, const std::vector<LampParams>& lamps,
                       const std::vector<ShadowMap>& maps, const Rect& rect, float near_m,
                       float far_m, LampSet among) {
  const Corners corners = corners_of(view, rect, near_m, far_m);
  LampSet set = 0;
  for (std::size_t k = 0; k < std::min(maps.size(), kLampBits); ++k)
    if (holds(among, k)) set |= LampSet{may_be_shadowed(lamps[k], maps[k], corners)} << k;
  return set;
}

bool has_shadows(const FrameParams& frame) {
  return !frame.contacts.empty() ||
         std::any_of(frame.lamps.begin(), frame.lamps.end(),
                     [](const LampParams& lamp) { return lamp.map_size_texel > 0; });
}

void light_background(Crew& crew, const LightInput& input, LightLayer& light) {
  Image<std::uint16_t>& out = light.background;
  std::fill(light.room_tiles.begin(), light.room_tiles.end(), BackgroundTile{});
  if (input.background.depth_m.empty()) return out.fill(kLit);
  crew.rows(out.height(), kLitTileHeight, [&](int begin, int end) {
    for (int x = 0; x < out.width(); x += kTilesTogether * kLitTileWidth)
      light_tiles(input, {x, begin, std::min(x + kTilesTogether * kLitTileWidth, out.width()), end},
                  out);
  });
}

void size_for_people(const FrameParams& frame, Size view_size, LightLayer& light) {
  const int rows = (view_size.height + kLitTileHeight - 1) / kLitTileHeight;
  light.room_tiles.resize(static_cast<std::size_t>(rows * tiles_across(view_size)));
  const Size size{static_cast<int>(corner_floats(frame.people_lamps.size())),
                  static_cast<int>(light.room_tiles.size())};
  light.corners.make(size);
  light.corners.reset(size);
}

void light_visible_background(Crew& crew, const LightInput& input, LightLayer& light) {
  const Size size = light.background.size();
  const bool past_people = input.people != nullptr && !input.background.depth_m.empty();
  crew.rows(size.height, kLitTileHeight, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      std::copy_n(light.background.row(y), size.width, light.visible.row(y));
    for (int x = 0; past_people && x < size.width; x += kLitTileWidth)
      light_tile_past_people(
          input, {x, begin, std::min(x + kLitTileWidth, size.width), end},
          static_cast<std::size_t>(begin / kLitTileHeight * tiles_across(size) + x / kLitTileWidth),
          light);
  });
}

}  // namespace mixrig::render::cpu
