// SPDX-License-Identifier: Apache-2.0
// Pass light: shades virtual surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/light/shade_others.h"
#include "host/render/cpu/light/shade_places.h"
#include "host/render/cpu/light/virtual_cells.h"

namespace mixrig::render::cpu {
namespace {

/// Largest relative difference of light between neighbouring squares of 2x2 pixels; a larger one
/// would be seen as a step.
constexpr float kMostOfSquare = 0.05F;

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

/// Light of the 2x2 pixels of a cell, to find those that a border of light passes.
class SquareLights {
 public:
  explicit SquareLights(const Rect& rect) : rect_(rect) {}
  void add(const Place& place, float light) {
    Range& range = ranges_[at(place.x, place.y)];
    range.least = std::min(range.least, light), range.most = std::max(range.most, light);
    range.looked_at_once |= place.side == 2;
  }
  bool find_uneven();
  /// Whether the square of pixel (x, y) is uneven. Call it after find_uneven().
  bool is_uneven(int x, int y) const { return ranges_[at(x, y)].uneven; }

 private:
  static constexpr int kSide = kCellPx / 2;
  struct Range {
    float least = std::numeric_limits<float>::max(), most = 0;
    bool looked_at_once = false, uneven = false;
  };
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>((y - rect_.y0) / 2 * kSide + (x - rect_.x0) / 2);
  }
  static bool differ(const Range& a, const Range& b) {
    return std::max(a.most, b.most) - std::min(a.least, b.least) >
           kMostOfSquare * std::max(a.most, b.most);
  }

  Rect rect_;
  std::array<Range, kSide * kSide> ranges_;
};

/// Marks squares that were looked at once and whose light differs from a neighbour's. Returns
/// whether there are any.
bool SquareLights::find_uneven() {
  bool any = false;
  const auto compare = [&](Range& a, Range& b) {
    if (a.most < a.least || b.most < b.least || !differ(a, b)) return;  // one is not covered
    a.uneven |= a.looked_at_once, b.uneven |= b.looked_at_once;
    any |= a.uneven || b.uneven;
  };
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const auto i = static_cast<std::size_t>(y * kSide + x);
      if (x + 1 < kSide) compare(ranges_[i], ranges_[i + 1]);
      if (y + 1 < kSide) compare(ranges_[i], ranges_[i + kSide]);
    }
  return any;
}

/// Albedo of a cell, which its shading takes the place of.
class CellAlbedo {
 public:
  CellAlbedo(const VirtualLayer& layer, const Rect& rect) : rect_(rect) {
    for (int y = rect.y0; y < rect.y1; ++y)
      std::copy_n(layer.color.row(y) + rect.x0, rect.x1 - rect.x0, row(y));
  }
  Rgbx16 at(int x, int y) const {
    return albedo_[static_cast<std::size_t>((y - rect_.y0) * kCellPx + x - rect_.x0)];
  }

 private:
  Rgbx16* row(int y) { return &albedo_[static_cast<std::size_t>((y - rect_.y0) * kCellPx)]; }

  Rect rect_;
  std::array<Rgbx16, kCellPx * kCellPx> albedo_;
};

/// Turns the albedo of a cell into shaded colour: light_at(places, at, lamp_light) is its light,
/// and adds what each whole lamp gives. Where light differs between 2x2 pixels that are looked at
/// once (at the border of a shadow), each of them is looked at by itself.
template <typename LightAt>
void shade_rect(const LightInput& input, const Rect& rect, VirtualLayer& layer,
                LightAt&& light_at) {
  std::vector<RoomFor<float>>& kept = layer.alone.lamp_light;
  std::array<FloatLanes, kMostLamps> of_lamps;
  const std::span lamp_light = std::span(of_lamps).first(kept.size());
  const CellAlbedo albedo(layer, rect);
  const auto shade = [&](std::span<const Place> places, const SurfaceLanes& at) {
    std::fill(lamp_light.begin(), lamp_light.end(), FloatLanes{});
    const ShadingLanes light = light_at(places, at, lamp_light);
    for_each_pixel(places, [&](int x, int y, int i) {
      layer.color.row(y)[x] = shaded(input, layer, x, y, albedo.at(x, y), light, i);
      for (std::size_t k = 0; k < kept.size(); ++k)
        kept[k].row(y - layer.rect.y0)[x - layer.rect.x0] = lamp_light[k][i];
    });
    return light;
  };
  const auto all = [](int, int) { return true; };
  // What is mirrored changes faster than the light that falls on a smooth surface.
  if (!layer.gloss.empty()) {
    for_each_place<Squares::kSingle>(input, rect, layer, all, shade);
    return;
  }
  SquareLights squares(rect);
  for_each_place<Squares::kOfTwo>(input, rect, layer, all,
                                  [&](std::span<const Place> places, const SurfaceLanes& at) {
                                    const ShadingLanes light = shade(places, at);
                                    for (int i = 0; const Place& place : places)
                                      squares.add(place, luminance(lane(light.diffuse, i++)));
                                  });
  if (!squares.find_uneven()) return;
  for_each_place<Squares::kSingle>(
      input, rect, layer, [&](int x, int y) { return squares.is_uneven(x, y); }, shade);
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
