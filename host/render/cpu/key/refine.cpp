// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/refine.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/key/key.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {
namespace {

using SumLanes = std::array<FloatLanes, RefineScratch::kSums>;
using LineLanes = std::array<FloatLanes, RefineScratch::kLine>;

ColorLanes guide(const Rgbx16* row, int x, int width) {
  const ColorLanes c = color_lanes(row, x, width);
  return {sqrt(c.r), sqrt(c.g), sqrt(c.b)};
}

/// Sums groups of kTilePx neighbouring lanes, into the first lanes.
template <int kTilePx>
FloatLanes fold(FloatLanes v) {
  if constexpr (kTilePx == 1) return v;
  const FloatLanes pairs = every<2, 0>(v, v) + every<2, 1>(v, v);
  return fold<std::max(1, kTilePx / 2)>(pairs);
}

/// Sums over the tiles in the columns x .. x + kLanes - 1 of row ty of tiles.
template <int kTilePx>
void sum_tiles(const Image<Rgbx16>& plate, const Image<std::uint8_t>& matte, int x, int ty,
               TileNumbers& sums) {
  const int width = matte.width(), y1 = std::min(matte.height(), (ty + 1) * kTilePx);
  const FloatLanes inside = lane_numbers() < FloatLanes{} + static_cast<float>(width - x)
                                ? FloatLanes{} + 1
                                : FloatLanes{};
  SumLanes s{};
  for (int y = ty * kTilePx; y < y1; ++y) {
    ColorLanes c = guide(plate.row(y), x, width);
    FloatLanes p = to_float(byte_lanes(matte.row(y), x, width)) * (1 / 255.0F);
    c = {c.r * inside, c.g * inside, c.b * inside}, p *= inside;
    const SumLanes pixel{inside,  p,         c.r,       c.g,       c.b,       p * c.r,   p * c.g,
                         p * c.b, c.r * c.r, c.r * c.g, c.r * c.b, c.g * c.g, c.g * c.b, c.b * c.b};
    for (std::size_t k = 0; k < s.size(); ++k) s[k] += pixel[k];
  }
  for (std::size_t k = 0; k < s.size(); ++k) {
    const FloatLanes tiles = fold<kTilePx>(s[k]);
    std::memcpy(sums.at(static_cast<int>(k), x / kTilePx, ty), &tiles, sizeof tiles / kTilePx);
  }
}

/// Sums over kLanes windows from tile (x, y) on.
SumLanes sum_windows(const RefineScratch& scratch, int x, int y) {
  constexpr int kReach = kMatteWindowTiles;
  SumLanes s{};
  for (int j = std::max(0, y - kReach); j <= std::min(scratch.tiles.height - 1, y + kReach); ++j)
    for (std::size_t k = 0; k < s.size(); ++k) {
      const float* row = scratch.sums.at(static_cast<int>(k), x, j);
      for (int i = -kReach; i <= kReach; ++i) s[k] += load<FloatLanes>(row + i);
    }
  return s;
}

/// Line and means of windows: a = (cov(c, c) + kMatteSpread2)^-1 cov(c, p), solved by cofactors.
LineLanes fit(const SumLanes& s) {
  const FloatLanes n = 1 / s[0], p = s[1] * n;
  const ColorLanes mean{n * s[2], n * s[3], n * s[4]};
  const ColorLanes with_p{n * s[5] - p * mean.r, n * s[6] - p * mean.g, n * s[7] - p * mean.b};
  const FloatLanes rr = n * s[8] - mean.r * mean.r + kMatteSpread2, rg = n * s[9] - mean.r * mean.g,
                   rb = n * s[10] - mean.r * mean.b,
                   gg = n * s[11] - mean.g * mean.g + kMatteSpread2,
                   gb = n * s[12] - mean.g * mean.b,
                   bb = n * s[13] - mean.b * mean.b + kMatteSpread2;
  const ColorLanes u{gg * bb - gb * gb, gb * rb - rg * bb, rg * gb - gg * rb};
  const ColorLanes v{u.g, rr * bb - rb * rb, rg * rb - rr * gb};
  const ColorLanes w{u.b, v.b, rr * gg - rg * rg};
  const FloatLanes over = 1 / (rr * u.r + rg * u.g + rb * u.b);
  const ColorLanes a{over * (with_p.r * u.r + with_p.g * v.r + with_p.b * w.r),
                     over * (with_p.r * u.g + with_p.g * v.g + with_p.b * w.g),
                     over * (with_p.r * u.b + with_p.g * v.b + with_p.b * w.b)};
  return {a.r, a.g, a.b, p - dot(a, mean), p, n * s[5], n * s[6], n * s[7]};
}

void fit_tiles(int x, int y, RefineScratch& scratch) {
  const LineLanes line = fit(sum_windows(scratch, x, y));
  for (std::size_t k = 0; k < line.size(); ++k)
    store(scratch.lines.at(static_cast<int>(k), x, y), line[k]);
}

/// Repeats the lines at the border for tiles beyond the picture.
void end_lines(int y, RefineScratch& scratch) {
  for (int k = 0; k < RefineScratch::kLine; ++k) {
    float* row = scratch.lines.at(k, 0, y);
    row[-1] = row[0], row[scratch.tiles.width] = row[scratch.tiles.width - 1];
  }
}

/// Positions of a register's pixels between tile centres, if its first pixel begins a tile: pixel i
/// is `part` of the way from tile `left(i)` - 1 to the next tile.
template <int kTilePx>
struct Between {
  static constexpr int left(int i) { return (2 * i + 1 + kTilePx) / (2 * kTilePx); }
  static constexpr float part(int i) {
    return static_cast<float>(2 * i + 1 + kTilePx) / (2 * kTilePx) - static_cast<float>(left(i));
  }
  template <std::size_t... i>
  static FloatLanes at(FloatLanes tiles, std::index_sequence<i...>) {
    constexpr FloatLanes kPart{part(i)...};
    const FloatLanes a = __builtin_shufflevector(tiles, tiles, left(i)...);
    const FloatLanes b = __builtin_shufflevector(tiles, tiles, (left(i) + 1)...);
    return a + kPart * (b - a);
  }
};

/// Lines for kLanes pixels of row y from x on, where x begins a tile: bilinear between the centres
/// of tiles.
template <int kTilePx>
LineLanes lines_at(const RefineScratch& s, int x, int y) {
  const float v = std::max(0.0F, (static_cast<float>(y) + 0.5F) / kTilePx - 0.5F);
  const int j = static_cast<int>(v), j1 = std::min(j + 1, s.tiles.height - 1);
  const float part = v - static_cast<float>(j);
  const int first = x / kTilePx - (kTilePx > 1 ? 1 : 0);
  LineLanes line;
  for (int k = 0; k < RefineScratch::kLine; ++k) {
    const auto above = load<FloatLanes>(s.lines.at(k, first, j));
    const auto below = load<FloatLanes>(s.lines.at(k, first, j1));
    FloatLanes& at = line[static_cast<std::size_t>(k)];
    at = above + part * (below - above);
    if constexpr (kTilePx > 1) at = Between<kTilePx>::at(at, std::make_index_sequence<kLanes>{});
  }
  return line;
}

/// Mixes the people's share by the line with their share by both colours, weighted by the latter's
/// confidence.
FloatLanes share_of_colors(const KeyInput& input, const RoomLight& light, const LineLanes& line,
                           FloatLanes share, int x, int y) {
  constexpr FloatLanes kNone{}, kAll = kNone + 1;
  const int width = input.tables.view_size.width;
  const ColorLanes p = color_lanes(input.plate.row(y), x, width);
  const ColorLanes learned = color_lanes(input.background.color.row(y), x, width);
  const ColorLanes now = shown_now(input.tone, learned), here = light.at(x, y / kBlockPx);
  const ColorLanes lit{here.r * now.r, here.g * now.g, here.b * now.b};
  const ColorLanes b = nearer_to(p, now, lit);
  const FloatLanes over = 1 / max(line[4], kNone + kShareLeast);
  const ColorLanes root{line[5] * over, line[6] * over, line[7] * over};
  const ColorLanes f{root.r * root.r, root.g * root.g, root.b * root.b};
  const ColorLanes apart{f.r - b.r, f.g - b.g, f.b - b.b}, off{p.r - b.r, p.g - b.g, p.b - b.b};
  const FloatLanes by_colors = dot(off, apart) / max(dot(apart, apart), kNone + 1e-6F);
  const ColorLanes rest{off.r - by_colors * apart.r, off.g - by_colors * apart.g,
                        off.b - by_colors * apart.b};
  const FloatLanes shade =
      min(max(dot(f, b) / max(dot(b, b), kNone + 1e-8F), kNone + kShareShadow), kAll);
  const ColorLanes unlike{f.r - shade * b.r, f.g - shade * b.g, f.b - shade * b.b};
  const FloatLanes sigma = kShareNoise + kSharePart * luminance(p), sigma2 = sigma * sigma;
  const FloatLanes unlike2 = dot(unlike, unlike);
  FloatLanes sure = unlike2 / (unlike2 + kShareApart * kShareApart * sigma2);
  sure *= sigma2 / (sigma2 + dot(rest, rest)) * max(4 * share * (1 - share), kNone);
  sure = (learned.r < 0) | (line[4] < kShareLeast) ? kNone : sure;
  return share + sure * (min(max(by_colors, kNone), kAll) - share);
}

template <int kTilePx>
void refine_row(const KeyInput& input, const RoomLight& light, const RefineScratch& scratch, int x0,
                int x1, int y, Image<std::uint8_t>& matte) {
  for (int x = x0; x < x1; x += kLanes) {
    const LineLanes line = lines_at<kTilePx>(scratch, x, y);
    const ColorLanes c = guide(input.plate.row(y), x, matte.width());
    FloatLanes share = line[0] * c.r + line[1] * c.g + line[2] * c.b + line[3];
    if (input.learned()) share = share_of_colors(input, light, line, share, x, y);
    const FloatLanes none{}, all = none + 1;
    const FloatLanes steep = min(max(0.5F + kMatteGain * (share - 0.5F), none), all);
    const ByteLanes bytes = to_bytes(truncate(255 * steep + 0.5F));
    std::memcpy(matte.row(y) + x, &bytes, static_cast<std::size_t>(std::min(kLanes, x1 - x)));
  }
}

template <int kTilePx>
void refine_by_tiles(Crew& crew, const KeyInput& input, const BlockPlanes& blocks,
                     const RoomLight& light, RefineScratch& scratch, Image<std::uint8_t>& matte) {
  constexpr int kPerBlock = kBlockPx / kTilePx, kGrain = 2;
  // Visits the runs of flagged blocks of each row.
  const auto runs = [&](const Image<std::uint8_t>& flags, auto&& visit) {
    crew.rows(flags.height(), kGrain, [&](int begin, int end) {
      for (int by = begin; by < end; ++by)
        block_runs(flags.row(by), flags.width(), flags.width(),
                   [&](int b0, int b1) { visit(by, block_begin(b0), block_begin(b1)); });
    });
  };
  const auto tile_rows = [&](int by, auto&& visit) {
    for (int y = by * kPerBlock; y < std::min((by + 1) * kPerBlock, scratch.tiles.height); ++y)
      visit(y);
  };
  runs(blocks.decided2, [&](int by, int x0, int x1) {
    tile_rows(by, [&](int ty) {
      for (int x = x0; x < x1; x += kLanes)
        sum_tiles<kTilePx>(input.plate, matte, x, ty, scratch.sums);
    });
  });
  runs(blocks.decided1, [&](int by, int x0, int x1) {
    tile_rows(by, [&](int ty) {
      for (int x = x0 / kTilePx; x < x1 / kTilePx; x += kLanes) fit_tiles(x, ty, scratch);
      end_lines(ty, scratch);
    });
  });
  runs(blocks.decided, [&](int by, int x0, int x1) {
    for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
      refine_row<kTilePx>(input, light, scratch, x0, std::min(x1, matte.width()), y, matte);
  });
}

}  // namespace

TileNumbers::TileNumbers(Size tiles, int count)
    : numbers(count), values({tiles.width + 4 * kMargin, tiles.height * count}) {}

RefineScratch::RefineScratch(Size view_size, float tof_footprint_px)
    : tile_px(matte_tile_px(tof_footprint_px)),
      tiles{(view_size.width + tile_px - 1) / tile_px, (view_size.height + tile_px - 1) / tile_px},
      sums(tiles, kSums),
      lines(tiles, kLine) {}

void refine(Crew& crew, const KeyInput& input, const BlockPlanes& blocks, const RoomLight& light,
            RefineScratch& scratch, Image<std::uint8_t>& matte) {
  if (scratch.tile_px == 4) return refine_by_tiles<4>(crew, input, blocks, light, scratch, matte);
  if (scratch.tile_px == 2) return refine_by_tiles<2>(crew, input, blocks, light, scratch, matte);
  refine_by_tiles<1>(crew, input, blocks, light, scratch, matte);
}

}  // namespace mixrig::render::cpu
