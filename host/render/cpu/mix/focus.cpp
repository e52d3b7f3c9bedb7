// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/mix/focus.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hal/base/srgb.h"
#include "host/render/frame/focus_discs.h"

namespace mixrig::render::cpu {
namespace {

/// 1/z in focus: fixed, or by the median of the known depths of 5 x 5 pixels; `last` if none is
/// known.
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

/// Cuts discs of radius 0, 1/2, 1 ... px into runs of their rows; a partly covered pixel is the end
/// of several runs.
void cut_into_chords(int most_radius, FocusScratch& s) {
  if (!s.chords_end.empty()) return;
  for (int step = 0; step <= 2 * most_radius; ++step) {
    const float r = 0.5F * static_cast<float>(step);
    const int reach = static_cast<int>(std::ceil(r)) + 1;
    const auto of = [r](int x, int y) {
      return focus_cover(std::hypot(static_cast<float>(x), static_cast<float>(y)), r);
    };
    for (int dy = -reach; dy <= reach; ++dy)
      for (int half = 0; half <= reach; ++half)
        if (const float weight = of(half, dy) - of(half + 1, dy); weight > 0)
          s.chords.push_back({dy, half, weight});
    s.chords_end.push_back(s.chords.size());
  }
}

void make_bytes(std::vector<std::uint8_t>& bytes) {
  if (!bytes.empty()) return;
  bytes.resize(65536);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = srgb_byte_from_linear(static_cast<float>(i) / 65535.0F);
}

void fill_row(int y, float blur_px_m, float most_radius_px, FocusScratch& s,
              const FrameOutput& output) {
  const std::array<float, 256>& linear = linear_of_srgb_bytes();
  const int width = output.color.width();
  const Rgb8* const color = output.color.row(y);
  const float* const depth = output.mixed_depth_m.row(y);
  float *r = s.r.row(y), *g = s.g.row(y), *b = s.b.row(y), *w = s.w.row(y);
  float *radius = s.radius_px.row(y), *share = s.share.row(y);
  std::array<float, 4> before{};  // running sums, for the margins too
  float last_w = s.focus_w;
  for (int x = 0; x < width; ++x) {
    const std::array<float, 4> light{linear[color[x].r], linear[color[x].g], linear[color[x].b], 1};
    for (std::size_t i = 0; i < 4; ++i) s.before[i].row(y)[x] = before[i], before[i] += light[i];
    if (depth[x] > 0) last_w = 1 / depth[x];
    w[x] = last_w;
    radius[x] = std::min(blur_px_m * std::abs(last_w - s.focus_w), most_radius_px);
    if (radius[x] < kFocusSharpPx) radius[x] = 0.5F;
    share[x] = 1 / s.disc_area[static_cast<std::size_t>(radius[x] * kFocusAreaSteps + 0.5F)];
    r[x] = share[x] * light[0], g[x] = share[x] * light[1], b[x] = share[x] * light[2];
  }
  for (std::size_t i = 0; i < 4; ++i)
    std::fill_n(s.before[i].row(y) + width, s.before[i].margin, before[i]);
}

struct FocusTiles {
  int x = 0, y = 0;
  explicit FocusTiles(Size size)
      : x((size.width + kFocusTileWide - 1) / kFocusTileWide),
        y((size.height + kFocusTileHigh - 1) / kFocusTileHigh) {}
  std::size_t at(int tx, int ty) const { return static_cast<std::size_t>(ty * x + tx); }
};

/// For the tiles of some rows: the largest disc, and whether neighbours belong to two surfaces.
void measure_tiles(Size size, const FocusTiles& tiles, float blur_px_m, int y, FocusScratch& s) {
  const float *w = s.w.row(y), *above = s.w.row(std::max(0, y - 1)), *radius = s.radius_px.row(y);
  for (int x = 0; x < size.width; ++x) {
    const std::size_t tile = tiles.at(x / kFocusTileWide, y / kFocusTileHigh);
    s.tile_radius_px[tile] = std::max(s.tile_radius_px[tile], radius[x]);
    const float off_w = std::max(std::abs(w[x] - above[x]), std::abs(w[x] - w[std::max(0, x - 1)]));
    if (off_w > focus_step(w[x], blur_px_m)) s.tile_step[tile] = 1;
  }
}

/// For each tile: the largest disc within `most_radius`, then whether tiles within that disc show
/// two surfaces.
void look_around(const FocusTiles& tiles, int most_radius, FocusScratch& s) {
  const auto around = [&](int tx, int ty, int reach, auto&& see) {
    const int wide = (reach + kFocusTileWide - 1) / kFocusTileWide,
              high = (reach + kFocusTileHigh - 1) / kFocusTileHigh;
    for (int y = std::max(0, ty - high); y <= std::min(tiles.y - 1, ty + high); ++y)
      for (int x = std::max(0, tx - wide); x <= std::min(tiles.x - 1, tx + wide); ++x)
        see(tiles.at(x, y));
  };
  for (int ty = 0; ty < tiles.y; ++ty)
    for (int tx = 0; tx < tiles.x; ++tx) {
      float most_px = 0;
      around(tx, ty, most_radius,
             [&](std::size_t tile) { most_px = std::max(most_px, s.tile_radius_px[tile]); });
      std::uint8_t step = 0;
      around(tx, ty, static_cast<int>(std::ceil(most_px)) + 1,
             [&](std::size_t tile) { step |= s.tile_step[tile]; });
      s.near_radius_px[tiles.at(tx, ty)] = most_px, s.near_step[tiles.at(tx, ty)] = step;
    }
}

/// Prepares the tables of all frames, and planes of this frame's size.
void prepare(Size size, int margin, FocusScratch& s) {
  for (FocusScratch::Plane* plane : {&s.r, &s.g, &s.b, &s.w, &s.radius_px, &s.share})
    plane->reset(size, margin);
  for (FocusScratch::Plane& plane : s.before) plane.reset(size, margin + 1);
  if (s.disc_area.empty()) s.disc_area = focus_disc_areas(margin);
  cut_into_chords(margin, s);
  make_bytes(s.srgb_byte);
  const FocusTiles tiles(size);
  const std::size_t count = tiles.at(0, tiles.y);
  s.tile_radius_px.assign(count, 0), s.near_radius_px.assign(count, 0);
  s.tile_step.assign(count, 0), s.near_step.assign(count, 0);
}

}  // namespace

void FocusScratch::Plane::reset(Size size, int margin_px) {
  margin = margin_px;
  stride = static_cast<std::size_t>(size.width + 2 * margin_px);
  // The margins keep their initial value, without light.
  values.resize(stride * static_cast<std::size_t>(size.height + 2 * margin_px), 0);
}

void draw_focus(Crew& crew, const Focus& focus, double fx_px, FocusScratch& s,
                FrameOutput& output) {
  const Size size = output.color.size();
  const float most_radius_px = 0.5F * focus.most_blur_px;
  const int margin = focus_margin(focus);
  prepare(size, margin, s);
  s.focus_w = focus_w(focus, output.mixed_depth_m, s.focus_w);
  const float blur_px_m = 0.5F * static_cast<float>(fx_px) * focus.aperture_m;
  const FocusTiles tiles(size);
  crew.rows(size.height, kFocusTileHigh, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) fill_row(y, blur_px_m, most_radius_px, s, output);
  });
  crew.rows(size.height, kFocusTileHigh, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) measure_tiles(size, tiles, blur_px_m, y, s);
  });
  look_around(tiles, margin, s);
  const FocusPass pass{s, blur_px_m, focus.fast ? kFocusFastFromPx : 1 << 20};
  crew.rows(size.height, kFocusTileHigh, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int tx = 0; tx < tiles.x; ++tx) {
        const std::size_t tile = tiles.at(tx, y / kFocusTileHigh);
        if (s.near_radius_px[tile] <= kFocusSharpPx) continue;
        const int x0 = tx * kFocusTileWide, count = std::min(kFocusTileWide, size.width - x0);
        if (s.near_step[tile] != 0)
          gather_focus_row(pass, x0, y, count, s.near_radius_px[tile], output.color);
        else
          blur_focus_row(pass, x0, y, count, output.color);
      }
  });
}

}  // namespace mixrig::render::cpu
