// SPDX-License-Identifier: Apache-2.0
// Pass light: shades virtual surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/light/shade_others.h"
#include "host/render/cpu/light/shade_places.h"
#include "host/render/cpu/light/virtual_cells.h"

namespace mixrig::render::cpu {
namespace {

ShadingLanes shading_in_cell(const LightInput& input, const VirtualCells& cells, int column,
                             int row, std::span<const Place> places, const SurfaceLanes& at,
                             std::span<FloatLanes> lamp_light) {
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
                 PastRoom::kInShare, lamp_light);
}

/// Turns the albedo of a rectangle into shaded colour. light_at(places, at, lamp_light) returns the
/// light, and adds the luminance of each whole lamp to lamp_light.
template <typename LightAt>
void shade_rect(const LightInput& input, const Rect& rect, VirtualLayer& layer,
                LightAt&& light_at) {
  const auto all = [](int, int) { return true; };
  std::vector<RoomFor<float>>& kept = layer.alone.lamp_light;
  std::array<FloatLanes, kMostLamps> of_lamps;
  const std::span lamp_light = std::span(of_lamps).first(kept.size());
  const auto shade = [&](std::span<const Place> places, const SurfaceLanes& at) {
    std::fill(lamp_light.begin(), lamp_light.end(), FloatLanes{});
    const ShadingLanes light = light_at(places, at, lamp_light);
    for_each_pixel(places, [&](int x, int y, int i) {
      Rgbx16& color = layer.color.row(y)[x];
      color = shaded(input, layer, x, y, color, light, i);
      for (std::size_t k = 0; k < kept.size(); ++k)
        kept[k].row(y - layer.rect.y0)[x - layer.rect.x0] = lamp_light[k][i];
    });
  };
  // Reflections change faster than the light that falls on a smooth surface.
  if (layer.gloss.empty())
    for_each_place<Squares::kOfTwo>(input, rect, layer, all, shade);
  else
    for_each_place<Squares::kSingle>(input, rect, layer, all, shade);
}

/// Shades each place of a rectangle by itself; `among`: lamps in doubt around it.
void shade_exactly(const LightInput& input, LampSet among, const Rect& rect, VirtualLayer& layer) {
  const auto [least_w, most_w] = positive_range(layer.w, rect);
  if (!(most_w > 0)) return;
  const LampSet maybe = lamps_in_doubt(input.tables.warp.view, input.frame.lamps, input.maps, rect,
                                       1 / most_w, 1 / least_w, among);
  shade_rect(input, rect, layer, [&](auto, const SurfaceLanes& at, auto lamp_light) {
    return shading(input.frame, input.maps, maybe, at, {}, PastRoom::kFind, lamp_light);
  });
}

void shade_tile(const LightInput& input, const Rect& tile, VirtualLayer& layer) {
  const auto [least_w, most_w] = positive_range(layer.w, tile);
  if (!(most_w > 0)) return;
  const LampSet maybe = lamps_in_doubt(input.tables.warp.view, input.frame.lamps, input.maps, tile,
                                       1 / most_w, 1 / least_w);
  if (input.maps.size() > kMostLamps ||
      !blur_allows_cells(input.tables.warp.view, input.frame.lamps, input.maps, maybe, tile,
                         1 / most_w, 1 / least_w))
    return each_cell([&](int column, int row) {
      shade_exactly(input, maybe, cell_rect(tile, column, row), layer);
    });
  const VirtualCells cells(input, maybe, tile, layer);
  each_cell([&](int column, int row) {
    const Rect rect = cell_rect(tile, column, row);
    if (!cells.is_smooth(column, row)) return shade_exactly(input, maybe, rect, layer);
    shade_rect(input, rect, layer, [&](auto places, const SurfaceLanes& at, auto lamp_light) {
      return shading_in_cell(input, cells, column, row, places, at, lamp_light);
    });
  });
}

}  // namespace

void shade_virtual(Crew& crew, const LightInput& input, VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  const bool people = keeps_alone(layer);
  if (people) begin_alone(layer);
  crew.rows(rect.y1 - rect.y0, kLitTileHeight, [&](int begin, int end) {
    const auto keep_rows = [&](RoomFor<Rgbx16>& to) {
      for (int y = begin; y < end; ++y)
        std::copy_n(layer.color.row(rect.y0 + y) + rect.x0, rect.x1 - rect.x0, to.row(y));
    };
    const int y0 = rect.y0 + begin, y1 = rect.y0 + end;
    if (people) keep_rows(layer.alone.albedo);
    for (int x = rect.x0; x < rect.x1; x += kLitTileWidth)
      shade_tile(input, {x, y0, std::min(x + kLitTileWidth, rect.x1), y1}, layer);
    if (people) keep_rows(layer.alone.color);
    shade_others(input, {rect.x0, y0, rect.x1, y1}, layer);
  });
}

}  // namespace mixrig::render::cpu
