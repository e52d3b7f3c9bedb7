// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/shadow.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "hal/base/give_back.h"

namespace mixrig::render::cpu {
namespace {

void draw_casters(const FrameParams& params, std::size_t lamp, const SampleGrid& grid, int y0,
                  int y1, Image<float>& map_w) {
  for (const Draw& draw : params.draws) {
    if (!draw.casts_shadow) continue;
    const glm::mat4& lamp_from_object =
        params.lamp_from_object[lamp][static_cast<std::size_t>(draw.object)];
    const MeshView& mesh = *draw.mesh;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const auto at = [&](std::size_t k) {
        return transform(lamp_from_object, mesh.positions_m[mesh.indices[i + k]]);
      };
      // Both faces cast shadows, so that an open sheet casts one from either side.
      const auto triangle = set_up(at(0), at(1), at(2), grid, Facing::kBoth);
      if (!triangle) continue;
      for_each_run(*triangle, y0, y1, map_w.width() - kLanes, 0,
                   [&](int x, int y, FloatLanes w, IntLanes inside) {
                     float* const to = map_w.row(y) + x;
                     store(to, max(load<FloatLanes>(to), inside ? w : FloatLanes{}));
                   });
    }
  }
}

/// Largest value of each cell of texels.
void reduce(const Image<float>& w, const Rect& rect, Image<float>& cells) {
  for (int y = rect.y0; y < rect.y1; ++y) {
    float* out = cells.row(y / kCellTexels);
    for (int x = rect.x0; x < rect.x1; ++x)
      out[x / kCellTexels] = std::max(out[x / kCellTexels], w.row(y)[x]);
  }
}

/// Makes windows of twice as many cells from windows of `side` cells.
void widen(const Image<float>& from, int side, Image<float>& to) {
  const int last_x = from.width() - 1, last_y = from.height() - 1;
  for (int y = 0; y <= last_y; ++y) {
    const float *upper = from.row(y), *lower = from.row(std::min(y + side, last_y));
    for (int x = 0; x <= last_x; ++x) {
      const int right = std::min(x + side, last_x);
      to.row(y)[x] = std::max(std::max(upper[x], upper[right]), std::max(lower[x], lower[right]));
    }
  }
}

}  // namespace

void draw_shadow_maps(Crew& crew, const FrameParams& params, std::vector<ShadowMap>& maps) {
  for (std::size_t i = 0; i < params.lamps.size(); ++i) {
    const LampParams& lamp = params.lamps[i];
    const int size = lamp.map_size_texel;
    const bool grows = maps[i].w.size() != Size{size, size};
    maps[i].w.reset({size, size});
    if (grows) give_back_as_zeros(maps[i].w);
    maps[i].drawn = {0, 0, size, size};
    if (size == 0) continue;
    const SampleGrid grid{
        glm::dvec2(lamp.map_focal_texel), glm::dvec2(lamp.map_center_texel), {0, 0, size, size}};
    // One band a thread, since every band sets up all triangles.
    crew.rows(size, (size + crew.threads() - 1) / crew.threads(),
              [&](int begin, int end) { draw_casters(params, i, grid, begin, end, maps[i].w); });
  }
  crew.rows(static_cast<int>(maps.size()), 1, [&](int begin, int) {
    ShadowMap& map = maps[static_cast<std::size_t>(begin)];
    if (!map.empty()) find_largest(map);
  });
}

void find_largest(ShadowMap& map) {
  const auto cells = [](int texels) { return (texels + kCellTexels - 1) / kCellTexels; };
  const Size size{cells(map.w.width()), cells(map.w.height())};
  const int longer = std::max(size.width, size.height);
  map.largest.resize(static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(longer))));
  for (Image<float>& level : map.largest) level.reset(size);
  reduce(map.w, map.drawn, map.largest[0]);
  for (std::size_t k = 1; k < map.largest.size(); ++k)
    widen(map.largest[k - 1], 1 << (k - 1), map.largest[k]);
}

float largest_w(const ShadowMap& map, float x0, float y0, float x1, float y1) {
  const float last = static_cast<float>(map.w.width() - 1);
  if (!(x1 >= 0 && y1 >= 0 && x0 <= last && y0 <= last)) return 0;
  const auto cell = [&](float texel) {
    return static_cast<int>(std::min(std::max(texel, 0.0F), last)) / kCellTexels;
  };
  const int left = cell(x0), top = cell(y0), right = cell(x1), bottom = cell(y1);
  const unsigned side = static_cast<unsigned>(std::max(right - left, bottom - top) + 1);
  const int level = std::bit_width(side) - 1, window = 1 << level;
  const Image<float>& largest = map.largest[static_cast<std::size_t>(level)];
  const int left2 = std::max(right - window + 1, 0), top2 = std::max(bottom - window + 1, 0);
  return std::max(std::max(largest.row(top)[left], largest.row(top)[left2]),
                  std::max(largest.row(top2)[left], largest.row(top2)[left2]));
}

}  // namespace mixrig::render::cpu
