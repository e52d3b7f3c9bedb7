// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/focus.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hal/base/srgb.h"

namespace mixrig::render::cpu {
namespace {

constexpr int kTileWide = 32, kTileHigh = 8;
constexpr int kAreaSteps = 16;  // of disc_area, to a pixel
constexpr float kNoLight = 1e-5F;
constexpr float kSharp_px = 0.6F;      // discs of this radius and less are one pixel
constexpr float kOneSurface = 0.06F;   // of 1/z: neighbours that are nearer to each other
constexpr float kSameBlur_px = 0.75F;  // or whose discs are as alike

/// Share of a pixel at distance d that a disc of radius r covers.
float cover(float d, float r) { return std::clamp(r + 0.5F - d, 0.0F, 1.0F); }

void measure_discs(int most_radius, std::vector<float>& area) {
  if (!area.empty()) return;
  area.resize(static_cast<std::size_t>((most_radius + 1) * kAreaSteps + 1));
  for (std::size_t i = 0; i < area.size(); ++i) {
    const float r = static_cast<float>(i) / kAreaSteps;
    const int reach = static_cast<int>(std::ceil(r)) + 1;
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        area[i] += cover(std::hypot(static_cast<float>(x), static_cast<float>(y)), r);
    area[i] = std::max(area[i], 1.0F);
  }
}

/// Median of the known depths of 5 x 5 pixels, as 1/z; `last` where none is known.
float focus_w(const Focus& focus, const Image<float>& depth_m, float last) {
  if (focus.distance_m > 0) return 1 / focus.distance_m;
  std::array<float, 25> known;
  std::size_t count = 0;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const int x = focus.pixel->x + dx, y = focus.pixel->y + dy;
      if (x < 0 || y < 0 || x >= depth_m.width() || y >= depth_m.height()) continue;
      if (const float z = depth_m.row(y)[x]; z > 0) known[count++] = 1 / z;
    }
  if (count == 0) return last;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(known.begin(), middle, known.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

/// Of one frame.
struct FocusPass {
  const FocusScratch& in;
  float blur_px_m = 0;  ///< radius over a difference of 1/z
  int stride_from_px = 1 << 20;
  int tiles_x = 0;
};

void fill_row(int y, float blur_px_m, float most_radius_px, FocusScratch& s,
              const FrameOutput& output) {
  const std::array<float, 256>& linear = linear_of_srgb_bytes();
  const int width = output.color.width();
  const Rgb8* const color = output.color.row(y);
  const float* const depth = output.mixed_depth_m.row(y);
  float *r = s.r.row(y), *g = s.g.row(y), *b = s.b.row(y), *w = s.w.row(y);
  float *radius = s.radius_px.row(y), *share = s.share.row(y);
  float last_w = s.focus_w;
  for (int x = 0; x < width; ++x) {
    r[x] = linear[color[x].r], g[x] = linear[color[x].g], b[x] = linear[color[x].b];
    if (depth[x] > 0) last_w = 1 / depth[x];
    w[x] = last_w;
    radius[x] = std::min(blur_px_m * std::abs(last_w - s.focus_w), most_radius_px);
    if (radius[x] < kSharp_px) radius[x] = 0.5F;
    const auto step = static_cast<std::size_t>(radius[x] * kAreaSteps + 0.5F);
    share[x] = 1 / s.disc_area[step];
  }
}

void find_tile_radii(Size size, int tiles_x, int tiles_y, int most_radius, FocusScratch& s) {
  const auto tiles = static_cast<std::size_t>(tiles_x * tiles_y);
  s.tile_radius_px.assign(tiles, 0), s.near_radius_px.assign(tiles, 0);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      float& most =
          s.tile_radius_px[static_cast<std::size_t>(y / kTileHigh * tiles_x + x / kTileWide)];
      most = std::max(most, s.radius_px.row(y)[x]);
    }
  const int wide = most_radius / kTileWide + 1, high = most_radius / kTileHigh + 1;
  for (int ty = 0; ty < tiles_y; ++ty)
    for (int tx = 0; tx < tiles_x; ++tx) {
      float& most = s.near_radius_px[static_cast<std::size_t>(ty * tiles_x + tx)];
      for (int y = std::max(0, ty - high); y <= std::min(tiles_y - 1, ty + high); ++y)
        for (int x = std::max(0, tx - wide); x <= std::min(tiles_x - 1, tx + wide); ++x)
          most = std::max(most, s.tile_radius_px[static_cast<std::size_t>(y * tiles_x + x)]);
    }
}

/// Light and share of the three layers, for the pixels of a piece of a row.
struct Layers {
  using Piece = std::array<float, kTileWide>;
  std::array<Piece, 4> before{}, own{}, behind{};  ///< red, green, blue, share
};

/// Adds the tap (dx, dy) to `count` pixels from (x0, y).
void add_tap(const FocusPass& pass, int x0, int y, int count, int dx, int dy, float weight,
             Layers& sum) {
  const FocusScratch& s = pass.in;
  const float d = std::hypot(static_cast<float>(dx), static_cast<float>(dy));
  const std::ptrdiff_t at = x0 + dx;
  const float *qr = s.r.row(y + dy) + at, *qg = s.g.row(y + dy) + at, *qb = s.b.row(y + dy) + at;
  const float *qw = s.w.row(y + dy) + at, *qradius = s.radius_px.row(y + dy) + at,
              *qshare = s.share.row(y + dy) + at;
  const float *w = s.w.row(y) + x0, *radius = s.radius_px.row(y) + x0;
  const float same_w = 2 * kSameBlur_px / std::max(2 * pass.blur_px_m, 1e-6F);
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const float step = std::max(kOneSurface * w[i], same_w);
    const bool is_behind = qw[i]<w[i] - step, is_before = qw[i]> w[i] + step;
    // Behind an edge the room is seen through the part of the lens that the edge leaves free.
    const float reach = is_behind ? std::max(qradius[i], radius[i]) : qradius[i];
    const float part = std::min(std::max(reach + 0.5F - d, 0.0F), 1.0F) * qshare[i] * weight;
    const float f = is_before ? part : 0.0F, b = is_behind ? part : 0.0F, o = part - f - b;
    sum.before[0][i] += f * qr[i], sum.before[1][i] += f * qg[i], sum.before[2][i] += f * qb[i];
    sum.before[3][i] += f;
    sum.own[0][i] += o * qr[i], sum.own[1][i] += o * qg[i], sum.own[2][i] += o * qb[i];
    sum.own[3][i] += o;
    sum.behind[0][i] += b * qr[i], sum.behind[1][i] += b * qg[i], sum.behind[2][i] += b * qb[i];
    sum.behind[3][i] += b;
  }
}

/// Before over own over behind; where a layer is empty the others make up for it.
Rgb8 resolve(const Layers& sum, std::size_t i) {
  const float behind = sum.behind[3][i] > kNoLight ? 1.0F : 0.0F;
  const float before = std::min(sum.before[3][i], 1.0F);
  const float own_share = std::min(sum.own[3][i], 1.0F);
  const float own = own_share * (1 - before), rest = behind * (1 - own_share) * (1 - before);
  const float total = std::max(before + own + rest, kNoLight);
  std::array<std::uint8_t, 3> bytes;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto mean = [i, c](const auto& layer) {
      return layer[c][i] / std::max(layer[3][i], kNoLight);
    };
    bytes[c] = srgb_byte_from_linear(
        (before * mean(sum.before) + own * mean(sum.own) + rest * mean(sum.behind)) / total);
  }
  return {bytes[0], bytes[1], bytes[2]};
}

void gather_row(const FocusPass& pass, int x0, int y, int count, float radius_px, Image<Rgb8>& to) {
  const int reach = static_cast<int>(std::ceil(radius_px));
  const int step = std::max(1, reach / pass.stride_from_px);
  const auto weight = static_cast<float>(step * step);
  Layers sum;
  const int first = -(reach / step) * step;
  for (int dy = first; dy <= reach; dy += step)
    for (int dx = first; dx <= reach; dx += step)
      if (static_cast<float>(dx * dx + dy * dy) < (radius_px + 0.5F) * (radius_px + 0.5F))
        add_tap(pass, x0, y, count, dx, dy, weight, sum);
  for (int i = 0; i < count; ++i) to.row(y)[x0 + i] = resolve(sum, static_cast<std::size_t>(i));
}

}  // namespace

void FocusScratch::Plane::reset(Size size, int margin_px) {
  margin = margin_px;
  stride = static_cast<std::size_t>(size.width + 2 * margin_px);
  // The margins stay as they are made: without light.
  values.resize(stride * static_cast<std::size_t>(size.height + 2 * margin_px), 0);
}

void draw_focus(Crew& crew, const Focus& focus, double fx_px, FocusScratch& s,
                FrameOutput& output) {
  const Size size = output.color.size();
  const float most_radius_px = 0.5F * focus.most_blur_px;
  const int margin = static_cast<int>(std::ceil(most_radius_px)) + 1;
  for (FocusScratch::Plane* plane : {&s.r, &s.g, &s.b, &s.w, &s.radius_px, &s.share})
    plane->reset(size, margin);
  measure_discs(margin, s.disc_area);
  s.focus_w = focus_w(focus, output.mixed_depth_m, s.focus_w);
  const float blur_px_m = 0.5F * static_cast<float>(fx_px) * focus.aperture_m;
  crew.rows(size.height, kTileHigh, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) fill_row(y, blur_px_m, most_radius_px, s, output);
  });
  const int tiles_x = (size.width + kTileWide - 1) / kTileWide;
  const int tiles_y = (size.height + kTileHigh - 1) / kTileHigh;
  find_tile_radii(size, tiles_x, tiles_y, margin, s);
  constexpr int kFastFrom_px = 5;  // the fast rung takes every second tap from twice this radius
  const FocusPass pass{s, blur_px_m, focus.fast ? kFastFrom_px : 1 << 20, tiles_x};
  crew.rows(size.height, kTileHigh, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int tx = 0; tx < tiles_x; ++tx) {
        const float radius_px =
            s.near_radius_px[static_cast<std::size_t>(y / kTileHigh * tiles_x + tx)];
        if (radius_px <= kSharp_px) continue;
        const int x0 = tx * kTileWide;
        gather_row(pass, x0, y, std::min(kTileWide, size.width - x0), radius_px, output.color);
      }
  });
}

}  // namespace mixrig::render::cpu
