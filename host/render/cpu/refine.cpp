// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/refine.h"

#include <algorithm>
#include <cmath>

#include "host/render/cpu/key.h"

namespace mixrig::render::cpu {
namespace {

struct TileRange {
  int x0, y0, x1, y1;
};

/// Tiles of a block.
TileRange tiles_of(const RefineScratch& s, int bx, int by) {
  const int per_block = kBlockPx / s.tile_px;
  return {bx * per_block, by * per_block, std::min(s.tiles.width, (bx + 1) * per_block),
          std::min(s.tiles.height, (by + 1) * per_block)};
}

std::size_t index(const RefineScratch& s, int x, int y) {
  return static_cast<std::size_t>(y * s.tiles.width + x);
}

glm::vec3 guide(Rgbx16 c) { return glm::sqrt(linear(c)); }

MatteSums sum_tile(const Image<Rgbx16>& plate, const Image<std::uint8_t>& matte, int tile_px,
                   int tx, int ty) {
  MatteSums s{};
  const int x1 = std::min(matte.width(), (tx + 1) * tile_px);
  const int y1 = std::min(matte.height(), (ty + 1) * tile_px);
  for (int y = ty * tile_px; y < y1; ++y)
    for (int x = tx * tile_px; x < x1; ++x) {
      const glm::vec3 c = guide(plate.row(y)[x]);
      const float p = static_cast<float>(matte.row(y)[x]) / 255;
      const MatteSums pixel{1,         p,         c.r,       c.g,       c.b,
                            p * c.r,   p * c.g,   p * c.b,   c.r * c.r, c.r * c.g,
                            c.r * c.b, c.g * c.g, c.g * c.b, c.b * c.b};
      for (std::size_t i = 0; i < s.size(); ++i) s[i] += pixel[i];
    }
  return s;
}

MatteSums sum_window(const RefineScratch& scratch, int tx, int ty) {
  constexpr int kReach = kMatteWindowTiles;
  MatteSums s{};
  for (int y = std::max(0, ty - kReach); y <= std::min(scratch.tiles.height - 1, ty + kReach); ++y)
    for (int x = std::max(0, tx - kReach); x <= std::min(scratch.tiles.width - 1, tx + kReach);
         ++x) {
      const MatteSums& tile = scratch.sums[index(scratch, x, y)];
      for (std::size_t i = 0; i < s.size(); ++i) s[i] += tile[i];
    }
  return s;
}

/// a = (cov(c, c) + kMatteSpread2)^-1 cov(c, p), by cofactors.
MatteLine fit(const MatteSums& s) {
  const float n = 1 / s[0], p = s[1] * n;
  const glm::vec3 mean = n * glm::vec3(s[2], s[3], s[4]);
  const glm::vec3 with_p = n * glm::vec3(s[5], s[6], s[7]) - p * mean;
  const float rr = n * s[8] - mean.r * mean.r + kMatteSpread2, rg = n * s[9] - mean.r * mean.g,
              rb = n * s[10] - mean.r * mean.b, gg = n * s[11] - mean.g * mean.g + kMatteSpread2,
              gb = n * s[12] - mean.g * mean.b, bb = n * s[13] - mean.b * mean.b + kMatteSpread2;
  const glm::vec3 u(gg * bb - gb * gb, gb * rb - rg * bb, rg * gb - gg * rb);
  const glm::vec3 v(u.y, rr * bb - rb * rb, rg * rb - rr * gb);
  const glm::vec3 w(u.z, v.z, rr * gg - rg * rg);
  const float determinant = rr * u.x + rg * u.y + rb * u.z;
  const glm::vec3 a = (with_p.r * u + with_p.g * v + with_p.b * w) / determinant;
  return {a.r, a.g, a.b, p - glm::dot(a, mean)};
}

/// Bilinear over the centres of tiles.
MatteLine line_at(const RefineScratch& s, int x, int y) {
  const float scale = 1 / static_cast<float>(s.tile_px);
  const float u = std::max(0.0F, (static_cast<float>(x) + 0.5F) * scale - 0.5F);
  const float v = std::max(0.0F, (static_cast<float>(y) + 0.5F) * scale - 0.5F);
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const int i1 = std::min(i + 1, s.tiles.width - 1), j1 = std::min(j + 1, s.tiles.height - 1);
  const float fu = u - static_cast<float>(i), fv = v - static_cast<float>(j);
  const MatteLine &a = s.lines[index(s, i, j)], &b = s.lines[index(s, i1, j)];
  const MatteLine &c = s.lines[index(s, i, j1)], &d = s.lines[index(s, i1, j1)];
  MatteLine line;
  for (std::size_t k = 0; k < line.size(); ++k)
    line[k] = (1 - fv) * ((1 - fu) * a[k] + fu * b[k]) + fv * ((1 - fu) * c[k] + fu * d[k]);
  return line;
}

void refine_block(const Image<Rgbx16>& plate, const RefineScratch& scratch, int bx, int by,
                  Image<std::uint8_t>& matte) {
  for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
    for (int x = block_begin(bx); x < block_end(bx, matte.width()); ++x) {
      const MatteLine line = line_at(scratch, x, y);
      const float share =
          glm::dot(glm::vec3(line[0], line[1], line[2]), guide(plate.row(y)[x])) + line[3];
      const float steep = std::clamp(0.5F + kMatteGain * (share - 0.5F), 0.0F, 1.0F);
      matte.row(y)[x] = static_cast<std::uint8_t>(255 * steep + 0.5F);
    }
}

}  // namespace

RefineScratch::RefineScratch(Size view_size, float tof_footprint_px)
    : tile_px(matte_tile_px(tof_footprint_px)),
      tiles{(view_size.width + tile_px - 1) / tile_px, (view_size.height + tile_px - 1) / tile_px},
      sums(tiles.area()),
      lines(tiles.area()) {}

void refine(Crew& crew, const Image<Rgbx16>& plate, const KeyScratch& key, RefineScratch& scratch,
            Image<std::uint8_t>& matte) {
  const auto tiles_near = [&](int reach, auto&& visit) {
    crew.rows(key.blocks_size.height, 2, [&](int begin, int end) {
      for (int by = begin; by < end; ++by)
        for (int bx = 0; bx < key.blocks_size.width; ++bx) {
          if (!key.near_decided(bx, by, reach)) continue;
          const TileRange r = tiles_of(scratch, bx, by);
          for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) visit(x, y);
        }
    });
  };
  tiles_near(2, [&](int x, int y) {
    scratch.sums[index(scratch, x, y)] = sum_tile(plate, matte, scratch.tile_px, x, y);
  });
  tiles_near(1, [&](int x, int y) {
    scratch.lines[index(scratch, x, y)] = fit(sum_window(scratch, x, y));
  });
  crew.rows(key.blocks_size.height, 2, [&](int begin, int end) {
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < key.blocks_size.width; ++bx)
        if (key.near_decided(bx, by, 0)) refine_block(plate, scratch, bx, by, matte);
  });
}

}  // namespace mixrig::render::cpu
