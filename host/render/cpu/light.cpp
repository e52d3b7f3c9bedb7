// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/contact.h"
#include "host/render/cpu/irradiance.h"

namespace mixrig::render::cpu {
namespace {

constexpr int kLightGrain = 16;
constexpr std::uint16_t kLit = 65535;

/// Background of one tile is tested together for shadows. A register divides its width.
constexpr int kTileWidth = 16, kTileHeight = 8;

std::uint16_t to_fixed(float share) {
  return static_cast<std::uint16_t>(kLinearOne * std::clamp(share, 0.0F, 1.0F) + 0.5F);
}

glm::vec3 ray_of(const PinholeParams& view, int x, int y) {
  return {(static_cast<float>(x) - view.center_px.x) / view.focal_px.x,
          (static_cast<float>(y) - view.center_px.y) / view.focal_px.y, 1};
}

glm::vec3 unpack(PackedNormal n, const glm::vec3& ray) {
  const glm::vec3 normal(n.x, n.y, n.z);
  return normal == glm::vec3(0) ? -glm::normalize(ray) : glm::normalize(normal);
}

/// Centre of tile i along an axis, in pixels.
float tile_center(int i) {
  return static_cast<float>(kLightTilePx * i) + 0.5F * static_cast<float>(kLightTilePx - 1);
}

/// Whether none of as many pixels as a Word has bytes shows a person.
template <typename Word>
bool no_people(const std::uint8_t* matte) {
  static_assert(kPersonByte == 128);
  constexpr Word kHighBits = static_cast<Word>(~Word{}) / 255 * 128;
  return (load<Word>(matte) & kHighBits) == 0;
}

/// Mean inverse depth of the people in a tile; 0 without people.
float mean_w(const Image<float>& view_w, const Image<std::uint8_t>& matte, int tile_x, int tile_y) {
  float sum = 0, count = 0;
  const int x1 = std::min((tile_x + 1) * kLightTilePx, matte.width());
  const int y1 = std::min((tile_y + 1) * kLightTilePx, matte.height());
  static_assert(kLightTilePx == sizeof(std::uint32_t));
  for (int y = tile_y * kLightTilePx; y < y1; ++y) {
    const int x0 = tile_x * kLightTilePx;
    if (x1 - x0 == kLightTilePx && no_people<std::uint32_t>(matte.row(y) + x0)) continue;
    for (int x = x0; x < x1; ++x)
      if (matte.row(y)[x] >= kPersonByte && view_w.row(y)[x] > 0)
        sum += view_w.row(y)[x], count += 1;
  }
  return count > 0 ? sum / count : 0;
}

/// A person's normal from the slope of w between tiles; towards the camera where it is not known.
glm::vec3 person_normal(const PinholeParams& view, const Image<float>& tile_w, int x, int y,
                        int reach, const glm::vec3& ray) {
  const auto w_at = [&](int i, int j) {
    const bool inside = i >= 0 && j >= 0 && i < tile_w.width() && j < tile_w.height();
    return inside ? tile_w.row(j)[i] : 0.0F;
  };
  const float left = w_at(x - reach, y), right = w_at(x + reach, y);
  const float above = w_at(x, y - reach), below = w_at(x, y + reach);
  if (!(left > 0 && right > 0 && above > 0 && below > 0)) return -glm::normalize(ray);
  const float per_px = 0.5F / static_cast<float>(reach * kLightTilePx);
  const float a = (right - left) * per_px * view.focal_px.x;
  const float b = (below - above) * per_px * view.focal_px.y;
  return -glm::normalize(glm::vec3(a, b, w_at(x, y) - a * ray.x - b * ray.y));
}

/// Light of a row of people's tiles.
void light_tiles(const LightInput& input, int y, LightLayer& light) {
  const PinholeParams& view = input.tables.warp.view;
  const int reach = normal_reach_tiles(input.tables.tof_footprint_px);
  const int columns = light.tile_w.width();
  const float* tile_w = light.tile_w.row(y);
  SurfaceLanes at;
  std::array<int, kLanes> tiles;
  int count = 0;
  const auto find = [&] {
    for (int i = count; i < kLanes; ++i) at.set(i, {0, 0, 1}, {0, 0, -1});
    const FloatLanes ratio = light_ratio(input.frame, input.maps, kAllLamps, true, at);
    for (int i = 0; i < count; ++i)
      light.tile_light.row(y)[tiles[static_cast<std::size_t>(i)]] = ratio[i];
    count = 0;
  };
  for (int x = 0; x < columns; ++x) {
    if (!(tile_w[x] > 0)) continue;
    const glm::vec2 px(tile_center(x), tile_center(y));
    const glm::vec3 ray((px - view.center_px) / view.focal_px, 1);
    at.set(count, ray / tile_w[x], person_normal(view, light.tile_w, x, y, reach, ray));
    tiles[static_cast<std::size_t>(count)] = x;
    if (++count == kLanes) find();
  }
  if (count > 0) find();
}

/// Bilinear over the tiles that hold people; 1 where none does.
float tile_light_at(const LightLayer& light, int x, int y) {
  const float u = (static_cast<float>(x) - tile_center(0)) / kLightTilePx;
  const float v = (static_cast<float>(y) - tile_center(0)) / kLightTilePx;
  const int i0 = static_cast<int>(std::floor(u)), j0 = static_cast<int>(std::floor(v));
  float sum = 0, weights = 0;
  for (int j = std::max(j0, 0); j <= std::min(j0 + 1, light.tile_w.height() - 1); ++j)
    for (int i = std::max(i0, 0); i <= std::min(i0 + 1, light.tile_w.width() - 1); ++i) {
      if (!(light.tile_w.row(j)[i] > 0)) continue;
      const float weight =
          (1 - std::abs(u - static_cast<float>(i))) * (1 - std::abs(v - static_cast<float>(j)));
      sum += weight * light.tile_light.row(j)[i];
      weights += weight;
    }
  return weights > 0 ? sum / weights : 1;
}

glm::vec3 lane(const VectorLanes& v, int i) { return {v.x[i], v.y[i], v.z[i]}; }

/// Of albedo `base`, premultiplied by `coverage`, both of kLinearOne.
glm::vec3 mirroring(const glm::vec3& base, float coverage, GlossBytes gloss,
                    const ShadingLanes& light, int i) {
  const float metallic = static_cast<float>(gloss.metallic) / 255;
  const float specular = static_cast<float>(gloss.specular) / 255;
  const glm::vec3 straight = glm::mix(glm::vec3(kDielectric * specular * coverage), base, metallic);
  const float grazing = glm::mix(specular, 1.0F, metallic) * coverage;
  const glm::vec3 diffuse =
      glm::max(lane(light.diffuse, i) - specular * lane(light.lost, i), glm::vec3(0));
  return (1 - metallic) * base * diffuse + straight * lane(light.straight, i) +
         grazing * lane(light.grazing, i);
}

/// Colour of a pixel of `albedo`, premultiplied as it.
Rgbx16 shaded(const LightInput& input, const VirtualLayer& layer, int x, int y, Rgbx16 albedo,
              const ShadingLanes& light, int i) {
  glm::vec3 c(albedo.r, albedo.g, albedo.b);
  if (layer.gloss.empty()) {
    c *= lane(light.diffuse, i);
  } else {
    const float coverage = kLinearOne / 255 * static_cast<float>(layer.coverage.row(y)[x]);
    c = mirroring(c, coverage, layer.gloss.row(y)[x], light, i);
  }
  if (!layer.emission.empty()) {
    const Rgbx16& own = layer.emission.row(y)[x];
    c += input.frame.light.exposure * glm::vec3(own.r, own.g, own.b);
  }
  c = glm::min(c + 0.5F, glm::vec3(kLinearOne));
  return {static_cast<std::uint16_t>(c.r), static_cast<std::uint16_t>(c.g),
          static_cast<std::uint16_t>(c.b), 0};
}

/// Lamps that may be hidden from the virtual surfaces of a tile.
struct TileLamps {
  LampSet by_people = 0, by_objects = 0;
};

/// Least and largest positive value of a rectangle; 0, 0 where none is.
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

/// What the rectangle's pixels show between two depths.
Corners corners_of(const PinholeParams& view, const Rect& rect, float near_m, float far_m) {
  Corners corners_m;
  for (std::size_t i = 0; i < 8; ++i)
    corners_m[i] = ray_of(view, i & 1 ? rect.x1 - 1 : rect.x0, i & 2 ? rect.y1 - 1 : rect.y0) *
                   (i & 4 ? far_m : near_m);
  return corners_m;
}

/// Lamps that may be hidden from anything that the rectangle's pixels show.
LampSet lamps_in_doubt(const PinholeParams& view, const std::vector<LampParams>& lamps,
                       const std::vector<ShadowMap>& maps, const Rect& rect, float near_m,
                       float far_m) {
  const Corners corners_m = corners_of(view, rect, near_m, far_m);
  LampSet set = 0;
  for (std::size_t k = 0; k < std::min(maps.size(), kLampBits); ++k)
    set |= LampSet{may_be_shadowed(lamps[k], maps[k], corners_m)} << k;
  return set;
}

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
void light_row(const LightInput& input, LampSet maybe, bool near, int y, int x0, int x1,
               std::uint16_t* out, const PeopleMaps* people = nullptr) {
  const float* depth_m = lit_depth_m(input).row(y);
  std::array<PackedNormal, kTileWidth> normals{};
  background_normals(input, x0, y, std::span(normals).first(static_cast<std::size_t>(x1 - x0)));
  for (int x = x0; x < x1; x += kLanes) {
    const FloatLanes depth = max(float_lanes(depth_m, x, x1), FloatLanes{});
    const VectorLanes ray = rays_of(input.tables.warp.view, x, y);
    const SurfaceLanes at{{ray.x * depth, ray.y * depth, ray.z * depth},
                          unpack(load<IntLanes>(normals.data() + (x - x0)), ray)};
    const FloatLanes ratio = light_ratio(input.frame, input.maps, maybe, near, at, people);
    for (int i = 0; i < std::min(kLanes, x1 - x); ++i)
      out[x - x0 + i] = depth[i] > 0 ? to_fixed(ratio[i]) : kLit;
  }
}

/// Columns or rows of a tile at which light is found where it is smooth.
template <std::size_t kCount>
std::array<int, kCount> every_fourth(int begin, int end) {
  std::array<int, kCount> at;
  for (std::size_t i = 0; i < kCount; ++i)
    at[i] = std::min(begin + 4 * static_cast<int>(i), end - 1);
  return at;
}

/// A tile that no lamp's shadow touches, on one surface: what objects hide of the ambient light
/// changes slowly, and is found at every fourth pixel. False where there is no surface at one.
bool light_smooth_tile(const LightInput& input, const Rect& rect, Image<std::uint16_t>& light) {
  constexpr std::size_t kColumns = kTileWidth / 4 + 1, kRows = kTileHeight / 4 + 1;
  const auto xs = every_fourth<kColumns>(rect.x0, rect.x1);
  const auto ys = every_fourth<kRows>(rect.y0, rect.y1);
  const ImageView<const float> depth_m = lit_depth_m(input);
  std::array<float, kColumns * kRows> found{};
  SurfaceLanes at;
  std::array<PackedNormal, kTileWidth> normals{};
  for (std::size_t k = 0; k < found.size(); ++k) {
    const int x = xs[k % kColumns], y = ys[k / kColumns];
    const float z = depth_m.row(y)[x];
    if (!(z > 0)) return false;
    if (k % kColumns == 0)
      background_normals(input, rect.x0, y,
                         std::span(normals).first(static_cast<std::size_t>(rect.x1 - rect.x0)));
    const glm::vec3 ray = ray_of(input.tables.warp.view, x, y);
    const std::size_t lane = k % kLanes;
    at.set(static_cast<int>(lane), ray * z,
           unpack(normals[static_cast<std::size_t>(x - rect.x0)], ray));
    if (lane + 1 < kLanes && k + 1 < found.size()) continue;
    const FloatLanes ratio = light_ratio(input.frame, input.maps, 0, true, at);
    for (std::size_t i = 0; i <= lane; ++i) found[k - lane + i] = ratio[static_cast<int>(i)];
  }
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      if (!(depth_m.row(y)[x] > 0)) continue;
      const auto i = static_cast<std::size_t>(x - rect.x0) / 4,
                 j = static_cast<std::size_t>(y - rect.y0) / 4;
      const float s = static_cast<float>(x - xs[i]) /
                      static_cast<float>(std::max(1, xs[i + 1] - xs[i])),
                  t = static_cast<float>(y - ys[j]) /
                      static_cast<float>(std::max(1, ys[j + 1] - ys[j]));
      const float* above = &found[j * kColumns + i];
      const float* below = above + kColumns;
      light.row(y)[x] = to_fixed((1 - t) * ((1 - s) * above[0] + s * above[1]) +
                                 t * ((1 - s) * below[0] + s * below[1]));
    }
  return true;
}

void light_tile(const LightInput& input, const Rect& rect, Image<std::uint16_t>& light) {
  for (int y = rect.y0; y < rect.y1; ++y)
    std::fill(light.row(y) + rect.x0, light.row(y) + rect.x1, kLit);
  const auto [near_m, far_m] = positive_range(lit_depth_m(input), rect);
  if (!(far_m > 0)) return;
  const LampSet maybe =
      lamps_in_doubt(input.tables.warp.view, input.frame.lamps, input.maps, rect, near_m, far_m);
  const bool near =
      may_be_near(input.frame, corners_of(input.tables.warp.view, rect, near_m, far_m));
  const bool no_shadow = maybe == 0 && input.maps.size() <= kLampBits;
  if (no_shadow && !near) return;
  constexpr float kOneSurface = 1.08F;  // farthest over nearest
  if (no_shadow && far_m < kOneSurface * near_m && light_smooth_tile(input, rect, light)) return;
  for (int y = rect.y0; y < rect.y1; ++y)
    light_row(input, maybe, near, y, rect.x0, rect.x1, light.row(y) + rect.x0);
}

/// Whether the 2x2 pixels from (x, y) on show one smooth surface: their light is alike.
bool is_smooth(const VirtualLayer& layer, int x, int y) {
  constexpr float kAlike = 0.01F;  // of the inverse depth
  const auto same = [&](int i, int j) {
    const PackedNormal a = layer.normal.row(y)[x], b = layer.normal.row(y + j)[x + i];
    const float w = layer.w.row(y)[x];
    return layer.coverage.row(y + j)[x + i] > 0 && a.x == b.x && a.y == b.y && a.z == b.z &&
           std::abs(layer.w.row(y + j)[x + i] - w) < kAlike * w;
  };
  return same(0, 0) && same(1, 0) && same(0, 1) && same(1, 1);
}

/// The square of pixels that one look at the lamps is for.
struct Place {
  int x = 0, y = 0, side = 1;
};

/// Whether smooth pixels are looked at together.
enum class Squares { kSingle, kOfTwo };

/// Calls shade(places, at) for the covered pixels of a tile, a register of places at a time.
template <Squares squares, typename Shade>
void for_each_place(const LightInput& input, const Rect& tile, const VirtualLayer& layer,
                    Shade&& shade) {
  SurfaceLanes at;
  std::array<Place, kLanes> places;
  int count = 0;
  const auto flush = [&] {
    for (int i = count; i < kLanes; ++i) at.set(i, {0, 0, 1}, {0, 0, -1});
    if (count > 0) shade(std::span(places).first(static_cast<std::size_t>(count)), at);
    count = 0;
  };
  const auto add = [&](const Place& p) {
    if (layer.coverage.row(p.y)[p.x] == 0) return;
    const glm::vec3 ray = ray_of(input.tables.warp.view, p.x, p.y);
    at.set(count, ray / layer.w.row(p.y)[p.x], unpack(layer.normal.row(p.y)[p.x], ray));
    if (!layer.gloss.empty())
      at.roughness[count] = static_cast<float>(layer.gloss.row(p.y)[p.x].roughness) / 255;
    places[static_cast<std::size_t>(count)] = p;
    if (++count == kLanes) flush();
  };
  for (int y = tile.y0; y < tile.y1; y += 2)
    for (int x = tile.x0; x < tile.x1; x += 2) {
      if (squares == Squares::kOfTwo && y + 1 < tile.y1 && x + 1 < tile.x1 &&
          is_smooth(layer, x, y)) {
        add({x, y, 2});
        continue;
      }
      for (int j = y; j < std::min(y + 2, tile.y1); ++j)
        for (int i = x; i < std::min(x + 2, tile.x1); ++i) add({i, j, 1});
    }
  flush();
}

/// Colour of a tile past people; the rest of it is without people.
void shade_tile_behind(const LightInput& input, const TileLamps& lamps, const Rect& tile,
                       VirtualLayer& layer) {
  for (int y = tile.y0; y < tile.y1; ++y)
    std::copy(layer.without_people.row(y) + tile.x0, layer.without_people.row(y) + tile.x1,
              layer.color.row(y) + tile.x0);
  if (lamps.by_people == 0) return;
  const PeopleMaps people{input.people->lamps, input.people->maps, lamps.by_people};
  for_each_place<Squares::kOfTwo>(
      input, tile, layer, [&](std::span<const Place> places, const auto& at) {
        ShadingLanes light;
        if (!shading_past_people(input.frame, input.maps, lamps.by_objects, people, at, light))
          return;
        for (int i = 0; const Place& p : places) {
          for (int y = p.y; y < p.y + p.side; ++y)
            for (int x = p.x; x < p.x + p.side; ++x)
              layer.color.row(y)[x] = shaded(input, layer, x, y, layer.albedo.row(y)[x], light, i);
          ++i;
        }
      });
}

/// Turns the albedo of a tile into shaded colour.
void shade_tile(const LightInput& input, const Rect& tile, VirtualLayer& layer) {
  const auto [least_w, most_w] = positive_range(layer.w, tile);
  if (!(most_w > 0)) return;
  const LampSet maybe = lamps_in_doubt(input.tables.warp.view, input.frame.lamps, input.maps, tile,
                                       1 / most_w, 1 / least_w);
  const auto shade = [&](std::span<const Place> places, const auto& at) {
    const ShadingLanes light = shading(input.frame, input.maps, maybe, at);
    for (int i = 0; const Place& p : places) {
      for (int y = p.y; y < p.y + p.side; ++y)
        for (int x = p.x; x < p.x + p.side; ++x) {
          Rgbx16& color = layer.color.row(y)[x];
          color = shaded(input, layer, x, y, color, light, i);
        }
      ++i;
    }
  };
  // What is mirrored changes faster than the light that falls on a smooth surface.
  if (layer.gloss.empty())
    for_each_place<Squares::kOfTwo>(input, tile, layer, shade);
  else
    for_each_place<Squares::kSingle>(input, tile, layer, shade);
}

TileLamps lamps_of_tile(const LightInput& input, const Rect& tile, const Image<float>& virtual_w) {
  const auto [least_w, most_w] = positive_range(virtual_w, tile);
  if (!(most_w > 0)) return {};
  const PinholeParams& view = input.tables.warp.view;
  const float near_m = 1 / most_w, far_m = 1 / least_w;
  TileLamps lamps;
  lamps.by_people =
      lamps_in_doubt(view, input.people->lamps, input.people->maps, tile, near_m, far_m);
  if (lamps.by_people != 0)
    lamps.by_objects = lamps_in_doubt(view, input.frame.lamps, input.maps, tile, near_m, far_m);
  return lamps;
}

/// A tile of the background that an object shades, past people.
void light_tile_past_people(const LightInput& input, const Rect& rect,
                            const Image<std::uint8_t>& matte, LightLayer& light) {
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
  std::array<std::uint16_t, kTileWidth> row;
  for (int y = rect.y0; y < rect.y1; ++y) {
    light_row(input, maybe, true, y, rect.x0, rect.x1, row.data(), &people);
    for (int x = rect.x0; x < rect.x1; ++x)
      if (matte.row(y)[x] < kPersonByte)
        light.visible.row(y)[x] = row[static_cast<std::size_t>(x - rect.x0)];
  }
}

}  // namespace

LightLayer::LightLayer(Size view_size) : background(view_size, kLit), visible(view_size, kLit) {
  const auto tiles = [](int px) { return (px + kLightTilePx - 1) / kLightTilePx; };
  tile_w.reset({tiles(view_size.width), tiles(view_size.height)});
  tile_light.reset(tile_w.size());
}

bool has_shadows(const FrameParams& frame) {
  return !frame.contacts.empty() ||
         std::any_of(frame.lamps.begin(), frame.lamps.end(),
                     [](const LampParams& lamp) { return lamp.map_size_texel > 0; });
}

void light_background(Crew& crew, const LightInput& input, LightLayer& light) {
  Image<std::uint16_t>& out = light.background;
  if (input.background.depth_m.empty()) return out.fill(kLit);
  crew.rows(out.height(), kTileHeight, [&](int begin, int end) {
    for (int x = 0; x < out.width(); x += kTileWidth)
      light_tile(input, {x, begin, std::min(x + kTileWidth, out.width()), end}, out);
  });
}

void light_past_people(Crew& crew, const LightInput& input, const Image<std::uint8_t>& matte,
                       LightLayer& light) {
  if (input.background.depth_m.empty()) return;
  const Size size = light.background.size();
  crew.rows(size.height, kTileHeight, [&](int begin, int end) {
    for (int x = 0; x < size.width; x += kTileWidth)
      light_tile_past_people(input, {x, begin, std::min(x + kTileWidth, size.width), end}, matte,
                             light);
  });
}

void shade_virtual(Crew& crew, const LightInput& input, VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  const bool people = !layer.albedo.empty();
  crew.rows(rect.y1 - rect.y0, kTileHeight, [&](int begin, int end) {
    const int y0 = rect.y0 + begin, y1 = rect.y0 + end;
    const auto copy_rows = [&](const Image<Rgbx16>& from, Image<Rgbx16>& to) {
      for (int y = y0; y < y1; ++y)
        std::copy(from.row(y) + rect.x0, from.row(y) + rect.x1, to.row(y) + rect.x0);
    };
    if (people) copy_rows(layer.color, layer.albedo);
    for (int x = rect.x0; x < rect.x1; x += kTileWidth)
      shade_tile(input, {x, y0, std::min(x + kTileWidth, rect.x1), y1}, layer);
    if (people) copy_rows(layer.color, layer.without_people);
  });
  if (people) layer.in_shadow.fill(0);
}

void size_for_people(Size view_size, VirtualLayer& layer) {
  layer.albedo.reset(view_size);
  layer.without_people.reset(view_size);
  layer.in_shadow.reset({(view_size.width + kTileWidth - 1) / kTileWidth,
                         (view_size.height + kTileHeight - 1) / kTileHeight});
}

void shade_behind_people(Crew& crew, const LightInput& input, VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  const Size tiles = layer.in_shadow.size();
  crew.rows(tiles.height, 1, [&](int row, int) {
    const int y0 = std::max(row * kTileHeight, rect.y0);
    const int y1 = std::min((row + 1) * kTileHeight, rect.y1);
    if (y0 >= y1) return;
    for (int column = 0; column < tiles.width; ++column) {
      const int x0 = std::max(column * kTileWidth, rect.x0);
      const int x1 = std::min((column + 1) * kTileWidth, rect.x1);
      if (x0 >= x1) continue;
      std::uint8_t& in_shadow = layer.in_shadow.row(row)[column];
      const TileLamps lamps = lamps_of_tile(input, {x0, y0, x1, y1}, layer.w);
      if (lamps.by_people != 0 || in_shadow != 0)
        shade_tile_behind(input, lamps, {x0, y0, x1, y1}, layer);
      in_shadow = lamps.by_people != 0 ? 1 : 0;
    }
  });
}

void light_people(Crew& crew, const LightInput& input, const Image<float>& view_w,
                  const Image<std::uint8_t>& matte, LightLayer& light) {
  const int columns = light.tile_w.width(), rows = light.tile_w.height();
  crew.rows(rows, kLightGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < columns; ++x) light.tile_w.row(y)[x] = mean_w(view_w, matte, x, y);
  });
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) light_tiles(input, y, light);
  });
  crew.rows(matte.height(), kLightGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      std::copy_n(light.background.row(y), matte.width(), light.visible.row(y));
      for (int x = 0; x < matte.width(); ++x) {
        constexpr int kWord = sizeof(std::uint64_t);
        while (x + kWord <= matte.width() && no_people<std::uint64_t>(matte.row(y) + x)) x += kWord;
        if (x < matte.width() && matte.row(y)[x] >= kPersonByte)
          light.visible.row(y)[x] = to_fixed(tile_light_at(light, x, y));
      }
    }
  });
}

}  // namespace mixrig::render::cpu
