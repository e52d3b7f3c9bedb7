// SPDX-License-Identifier: Apache-2.0
// Pass light: the shading of virtual surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/light_parts.h"
#include "host/render/cpu/virtual_cells.h"

namespace mixrig::render::cpu {
namespace {

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

/// Calls shade(places, at) for the covered pixels of a tile that are wanted(x, y), which 2x2 of
/// them are together, a register of places at a time.
template <Squares squares, typename Wanted, typename Shade>
void for_each_place(const LightInput& input, const Rect& tile, const VirtualLayer& layer,
                    Wanted&& wanted, Shade&& shade) {
  SurfaceLanes at;
  std::array<Place, kLanes> places;
  int count = 0;
  const auto flush = [&] {
    for (int i = count; i < kLanes; ++i) at.set(i, {0, 0, 1}, glm::vec3(0));  // no lamp lights it
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
      if (!wanted(x, y)) continue;
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

/// Whether a colour of these squares was cut off, so that what people take cannot be told from it.
bool is_cut(const Image<Rgbx16>& color, std::span<const Place> places) {
  const auto most = static_cast<std::uint16_t>(kLinearOne);
  for (const Place& p : places)
    for (int y = p.y; y < p.y + p.side; ++y)
      for (int x = p.x; x < p.x + p.side; ++x) {
        const Rgbx16 c = color.row(y)[x];
        if (std::max({c.r, c.g, c.b}) >= most) return true;
      }
  return false;
}

/// Colour of a matte pixel without the light that people take.
Rgbx16 darker(Rgbx16 color, Rgbx16 albedo, const glm::vec3& taken) {
  const glm::vec3 c = glm::max(
      glm::vec3(color.r, color.g, color.b) - glm::vec3(albedo.r, albedo.g, albedo.b) * taken + 0.5F,
      glm::vec3(0));
  return {static_cast<std::uint16_t>(c.r), static_cast<std::uint16_t>(c.g),
          static_cast<std::uint16_t>(c.b), 0};
}

/// Calls set(x, y, i) for the pixels of square number i.
template <typename Set>
void for_each_pixel(std::span<const Place> places, Set&& set) {
  for (int i = 0; const Place& p : places) {
    for (int y = p.y; y < p.y + p.side; ++y)
      for (int x = p.x; x < p.x + p.side; ++x) set(x, y, i);
    ++i;
  }
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
      input, tile, layer, [](int, int) { return true; },
      [&](std::span<const Place> places, const auto& at) {
        if (layer.gloss.empty() && !is_cut(layer.without_people, places)) {
          VectorLanes taken;
          if (!taken_by_people(input.frame, input.maps, lamps.by_objects, people, at, taken))
            return;
          return for_each_pixel(places, [&](int x, int y, int i) {
            layer.color.row(y)[x] =
                darker(layer.without_people.row(y)[x], layer.albedo.row(y)[x], lane(taken, i));
          });
        }
        ShadingLanes light;
        if (!shading_past_people(input.frame, input.maps, lamps.by_objects, people, at, light))
          return;
        for_each_pixel(places, [&](int x, int y, int i) {
          layer.color.row(y)[x] = shaded(input, layer, x, y, layer.albedo.row(y)[x], light, i);
        });
      });
}

ShadingLanes shading_in_cell(const LightInput& input, const VirtualCells& cells, int column,
                             int row, std::span<const Place> places, const SurfaceLanes& at) {
  FloatLanes x{}, y{};
  for (int i = 0; const Place& p : places) {
    const float middle = 0.5F * static_cast<float>(p.side - 1);
    x[i] = static_cast<float>(p.x) + middle, y[i] = static_cast<float>(p.y) + middle;
    ++i;
  }
  const LampSet to_find = cells.lamps_to_find(column, row);
  std::array<FloatLanes, kMostLamps> share;
  const std::size_t count = std::min(input.maps.size(), share.size());
  cells.shares(column, row, to_find, x, y, share);
  return shading(input.frame, input.maps, to_find, at, std::span(share).first(count),
                 PastRoom::kInShare);
}

/// Turns the albedo of a rectangle into shaded colour: light_at(places, at) is its light.
template <typename LightAt>
void shade_rect(const LightInput& input, const Rect& rect, VirtualLayer& layer,
                LightAt&& light_at) {
  const auto all = [](int, int) { return true; };
  const auto shade = [&](std::span<const Place> places, const SurfaceLanes& at) {
    const ShadingLanes light = light_at(places, at);
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
    for_each_place<Squares::kOfTwo>(input, rect, layer, all, shade);
  else
    for_each_place<Squares::kSingle>(input, rect, layer, all, shade);
}

/// Each pixel of a rectangle by itself; `among`: lamps in doubt around it.
void shade_exactly(const LightInput& input, LampSet among, const Rect& rect, VirtualLayer& layer) {
  const auto [least_w, most_w] = positive_range(layer.w, rect);
  if (!(most_w > 0)) return;
  const LampSet maybe = lamps_in_doubt(input.tables.warp.view, input.frame.lamps, input.maps, rect,
                                       1 / most_w, 1 / least_w, among);
  shade_rect(input, rect, layer, [&](std::span<const Place>, const SurfaceLanes& at) {
    return shading(input.frame, input.maps, maybe, at);
  });
}

void shade_tile(const LightInput& input, const Rect& tile, VirtualLayer& layer) {
  const auto [least_w, most_w] = positive_range(layer.w, tile);
  if (!(most_w > 0)) return;
  const LampSet maybe = lamps_in_doubt(input.tables.warp.view, input.frame.lamps, input.maps, tile,
                                       1 / most_w, 1 / least_w);
  if (input.maps.size() > kMostLamps ||
      !blur_allows_cells(input, maybe, tile, 1 / most_w, 1 / least_w))
    return each_cell([&](int column, int row) {
      shade_exactly(input, maybe, cell_rect(tile, column, row), layer);
    });
  const VirtualCells cells(input, maybe, tile, layer);
  each_cell([&](int column, int row) {
    const Rect rect = cell_rect(tile, column, row);
    if (!cells.is_smooth(column, row)) return shade_exactly(input, maybe, rect, layer);
    shade_rect(input, rect, layer, [&](std::span<const Place> places, const SurfaceLanes& at) {
      return shading_in_cell(input, cells, column, row, places, at);
    });
  });
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
}  // namespace

void shade_virtual(Crew& crew, const LightInput& input, VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  const bool people = !layer.albedo.empty();
  crew.rows(rect.y1 - rect.y0, kLitTileHeight, [&](int begin, int end) {
    const int y0 = rect.y0 + begin, y1 = rect.y0 + end;
    const auto copy_rows = [&](const Image<Rgbx16>& from, Image<Rgbx16>& to) {
      for (int y = y0; y < y1; ++y)
        std::copy(from.row(y) + rect.x0, from.row(y) + rect.x1, to.row(y) + rect.x0);
    };
    if (people) copy_rows(layer.color, layer.albedo);
    for (int x = rect.x0; x < rect.x1; x += kLitTileWidth)
      shade_tile(input, {x, y0, std::min(x + kLitTileWidth, rect.x1), y1}, layer);
    if (people) copy_rows(layer.color, layer.without_people);
  });
  if (people) layer.in_shadow.fill(0);
}

void size_for_people(Size view_size, VirtualLayer& layer) {
  layer.albedo.reset(view_size);
  layer.without_people.reset(view_size);
  layer.in_shadow.reset({(view_size.width + kLitTileWidth - 1) / kLitTileWidth,
                         (view_size.height + kLitTileHeight - 1) / kLitTileHeight});
}

void shade_behind_people(Crew& crew, const LightInput& input, VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  const Size tiles = layer.in_shadow.size();
  crew.rows(tiles.height, 1, [&](int row, int) {
    const int y0 = std::max(row * kLitTileHeight, rect.y0);
    const int y1 = std::min((row + 1) * kLitTileHeight, rect.y1);
    if (y0 >= y1) return;
    for (int column = 0; column < tiles.width; ++column) {
      const int x0 = std::max(column * kLitTileWidth, rect.x0);
      const int x1 = std::min((column + 1) * kLitTileWidth, rect.x1);
      if (x0 >= x1) continue;
      std::uint8_t& in_shadow = layer.in_shadow.row(row)[column];
      const TileLamps lamps = lamps_of_tile(input, {x0, y0, x1, y1}, layer.w);
      if (lamps.by_people != 0 || in_shadow != 0)
        shade_tile_behind(input, lamps, {x0, y0, x1, y1}, layer);
      in_shadow = lamps.by_people != 0 ? 1 : 0;
    }
  });
}

}  // namespace mixrig::render::cpu
