// SPDX-License-Identifier: Apache-2.0
// Pass light: shades virtual surfaces past people.
#include <algorithm>
#include <array>
#include <bit>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/light/people_cells.h"
#include "host/render/cpu/light/shade_others.h"
#include "host/render/cpu/light/shade_places.h"
#include "host/render/cpu/light/virtual_cells.h"

namespace mixrig::render::cpu {
namespace {

/// Exposed colour of each lamp at luminance 1.
using LampColors = std::array<F4, kMostLamps>;

/// Lamps that people may hide from the virtual surfaces of a tile, and the tile's extent.
struct TileLamps {
  LampSet by_people = 0;
  float near_m = 0, far_m = 0;
};

TileLamps lamps_of_tile(const LightInput& input, const Rect& tile, const Image<float>& virtual_w) {
  const auto [least_w, most_w] = positive_range(virtual_w, tile);
  if (!(most_w > 0)) return {};
  const PinholeParams& view = input.tables.warp.view;
  TileLamps lamps{0, 1 / most_w, 1 / least_w};
  lamps.by_people = lamps_in_doubt(view, input.people->lamps, input.people->maps, tile,
                                   lamps.near_m, lamps.far_m, input.people->reach);
  return lamps;
}

F4 to_f4(Rgbx16 p) { return __builtin_convertvector(std::bit_cast<U16x4>(p), F4); }

/// Shades the pixels of a tile past people.
class TilePastPeople {
 public:
  TilePastPeople(const LightInput& input, const TileLamps& lamps, const LampColors& colors,
                 const Rect& tile, VirtualLayer& layer)
      : input_(input),
        lamps_(lamps),
        colors_(colors),
        people_{input.people->lamps, input.people->maps, input.people->grid, lamps.by_people},
        tile_(tile),
        layer_(layer),
        count_(layer.alone.lamp_light.size()) {}
  void shade();

 private:
  void shade_nearest();
  void shade_cell(const PeopleCells& cells, int column, int row);
  void shade_places(const Rect& rect);
  void shade_anew(const Rect& rect);
  bool is_cut(const Rect& rect) const;
  /// Removes the light that people take: share(k) is the visible share of lamp k.
  template <typename Share>
  void darken(int x, int y, Share&& share) {
    const ShadedAlone& alone = layer_.alone;
    const int i = x - layer_.rect.x0, j = y - layer_.rect.y0;
    F4 taken{};
    for (std::size_t k = 0; k < count_; ++k)
      if (holds(lamps_.by_people, k))
        taken += (1 - share(k)) * alone.lamp_light[k].row(j)[i] * colors_[k];
    const F4 c = to_f4(alone.color.row(j)[i]) - to_f4(alone.albedo.row(j)[i]) * taken + 0.5F;
    const F4 left = c > 0 ? c : F4{};
    layer_.color.row(y)[x] =
        std::bit_cast<Rgbx16>(__builtin_convertvector(__builtin_convertvector(left, I4), U16x4));
  }

  const LightInput& input_;
  TileLamps lamps_;
  const LampColors& colors_;
  PeopleMaps people_;
  Rect tile_;
  VirtualLayer& layer_;
  std::size_t count_;  ///< number of whole lamps
};

/// Whether a colour was clipped, so that light cannot be subtracted from it.
bool TilePastPeople::is_cut(const Rect& rect) const {
  const auto most = static_cast<std::uint16_t>(kLinearOne);
  for (int y = rect.y0; y < rect.y1; ++y) {
    const Rgbx16* row = layer_.alone.color.row(y - layer_.rect.y0) - layer_.rect.x0;
    for (int x = rect.x0; x < rect.x1; ++x)
      if (std::max({row[x].r, row[x].g, row[x].b}) >= most) return true;
  }
  return false;
}

/// Shades a rectangle with all lamps again.
void TilePastPeople::shade_anew(const Rect& rect) {
  const LampSet by_objects = lamps_in_doubt(input_.tables.warp.view, input_.frame.lamps,
                                            input_.maps, rect, lamps_.near_m, lamps_.far_m);
  for_each_place<Squares::kOfTwo>(
      input_, rect, layer_, [](int, int) { return true; },
      [&](std::span<const Place> places, const SurfaceLanes& at) {
        ShadingLanes light;
        if (!shading_past_people(input_.frame, input_.maps, by_objects, people_, at, light)) return;
        for_each_pixel(places, [&](int x, int y, int i) {
          const Rgbx16 albedo = layer_.alone.albedo.row(y - layer_.rect.y0)[x - layer_.rect.x0];
          layer_.color.row(y)[x] = shaded(input_, layer_, x, y, albedo, light, i);
        });
      });
}

/// Evaluates people's shadows at each place of a rectangle.
void TilePastPeople::shade_places(const Rect& rect) {
  if (is_cut(rect)) return shade_anew(rect);
  for_each_place<Squares::kOfTwo>(
      input_, rect, layer_, [](int, int) { return true; },
      [&](std::span<const Place> places, const SurfaceLanes& at) {
        std::array<FloatLanes, kMostLamps> seen;
        if (!seen_past_people(people_, at, seen)) return;
        for_each_pixel(places, [&](int x, int y, int i) {
          darken(x, y, [&](std::size_t k) { return seen[k][i]; });
        });
      });
}

void TilePastPeople::shade_cell(const PeopleCells& cells, int column, int row) {
  const CellOf c = cell(column, row);
  const Rect rect = cell_rect(tile_, column, row);
  if (cells.change(c)) return shade_places(rect);
  if (!cells.hide(c)) return;
  if (is_cut(rect)) return shade_anew(rect);
  std::array<std::array<float, kCellPx * kCellPx>, kMostLamps> seen;
  for (std::size_t k = 0; k < count_; ++k)
    if (holds(lamps_.by_people, k))
      between(cells.seen()[k], c, [&](int x, int y, float share) {
        seen[k][static_cast<std::size_t>(y * kCellPx + x)] = share;
      });
  for (int y = 0; y < kCellPx; ++y)
    for (int x = 0; x < kCellPx; ++x)
      darken(rect.x0 + x, rect.y0 + y,
             [&](std::size_t k) { return seen[k][static_cast<std::size_t>(y * kCellPx + x)]; });
}

void TilePastPeople::shade() {
  for (int y = tile_.y0; y < tile_.y1; ++y)
    std::copy_n(layer_.alone.color.row(y - layer_.rect.y0) + (tile_.x0 - layer_.rect.x0),
                tile_.x1 - tile_.x0, layer_.color.row(y) + tile_.x0);
  if (lamps_.by_people != 0) shade_nearest();
  add_others_past_people(input_, people_, tile_, layer_);
}

void TilePastPeople::shade_nearest() {
  const PinholeParams& view = input_.tables.warp.view;
  if (!layer_.gloss.empty()) return shade_anew(tile_);
  const VirtualCorners corners(view, tile_, layer_);
  if (!corners.any_smooth() ||
      !people_allow_cells(view, people_, tile_, lamps_.near_m, lamps_.far_m))
    return shade_places(tile_);
  const PeopleCells cells(people_, corners.at());
  each_cell([&](int column, int row) {
    if (corners.is_smooth(column, row)) return shade_cell(cells, column, row);
    shade_places(cell_rect(tile_, column, row));
  });
}

LampColors lamp_colors(const FrameParams& frame) {
  LampColors colors{};
  for (std::size_t k = 0; k < std::min(frame.people_lamps.size(), colors.size()); ++k) {
    const glm::vec3& intensity = frame.people_lamps[k].intensity;
    const float luminance_of = luminance(intensity);
    if (!(luminance_of > 0)) continue;
    const glm::vec3 color = frame.light.exposure / luminance_of * intensity;
    colors[k] = F4{color.r, color.g, color.b, 0};
  }
  return colors;
}

}  // namespace

void size_for_people(const FrameParams& frame, Size view_size, VirtualLayer& layer) {
  ShadedAlone& alone = layer.alone;
  alone.albedo.make(view_size), alone.color.make(view_size);
  alone.lamp_light.resize(std::min<std::size_t>(frame.people_lamps.size(), kMostLamps));
  for (RoomFor<float>& light : alone.lamp_light) light.make(view_size);
  alone.in_shadow.reset({(view_size.width + kLitTileWidth - 1) / kLitTileWidth,
                         (view_size.height + kLitTileHeight - 1) / kLitTileHeight});
}

void begin_alone(VirtualLayer& layer) {
  ShadedAlone& alone = layer.alone;
  alone.in_shadow.fill(0), alone.any_in_shadow = false;
  const Size size{layer.rect.x1 - layer.rect.x0, layer.rect.y1 - layer.rect.y0};
  alone.albedo.reset(size), alone.color.reset(size);
  for (RoomFor<float>& light : alone.lamp_light) light.reset(size);
}

bool shade_behind_people(Crew& crew, const LightInput& input, VirtualLayer& layer) {
  const Rect& rect = layer.rect;
  Image<std::uint8_t>& in_shadow = layer.alone.in_shadow;
  const bool any = input.people->reach != 0;
  if (!any && !layer.alone.any_in_shadow) return false;
  layer.alone.any_in_shadow = any;
  const LampColors colors = lamp_colors(input.frame);
  crew.rows(in_shadow.height(), 1, [&](int row, int) {
    const int y0 = std::max(row * kLitTileHeight, rect.y0);
    const int y1 = std::min((row + 1) * kLitTileHeight, rect.y1);
    if (y0 >= y1) return;
    for (int column = 0; column < in_shadow.width(); ++column) {
      const int x0 = std::max(column * kLitTileWidth, rect.x0);
      const int x1 = std::min((column + 1) * kLitTileWidth, rect.x1);
      if (x0 >= x1) continue;
      const Rect tile{x0, y0, x1, y1};
      const TileLamps lamps = lamps_of_tile(input, tile, layer.w);
      std::uint8_t& was = in_shadow.row(row)[column];
      if (lamps.by_people != 0 || was != 0)
        TilePastPeople(input, lamps, colors, tile, layer).shade();
      was = lamps.by_people != 0 ? 1 : 0;
    }
  });
  return true;
}

}  // namespace mixrig::render::cpu
