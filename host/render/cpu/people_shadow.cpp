// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/people_shadow.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "host/render/cpu/light_parts.h"

namespace mixrig::render::cpu {
namespace {

/// Where nobody is, farther than every body.
constexpr float kNobodyM = 1e9F;

/// Depth of a block's people, the inverse of their mean w; kNobodyM where they fill less than half
/// of it.
float people_m(const Image<float>& view_w, const Image<std::uint8_t>& matte, int bx, int by) {
  static_assert(kBlockPx == sizeof(std::uint64_t));
  const int x0 = bx * kBlockPx, y0 = by * kBlockPx;
  const int x1 = std::min(x0 + kBlockPx, matte.width()),
            y1 = std::min(y0 + kBlockPx, matte.height());
  float sum = 0;
  int count = 0;
  for (int y = y0; y < y1; ++y) {
    if (x1 - x0 == kBlockPx && no_people<std::uint64_t>(matte.row(y) + x0)) continue;
    for (int x = x0; x < x1; ++x) {
      if (matte.row(y)[x] < kPersonByte || !(view_w.row(y)[x] > 0)) continue;
      sum += view_w.row(y)[x];
      ++count;
    }
  }
  return 2 * count >= (x1 - x0) * (y1 - y0) && count > 0 ? static_cast<float>(count) / sum
                                                         : kNobodyM;
}

struct Surroundings {
  float blocks_to_silhouette = 0;  ///< to the nearest block of another surface, less half of one
  float behind_m = 0;              ///< the nearest part of the body around, no limb before it
};

/// Of the middle of (bx, by); a person goes on past the border of the view.
Surroundings surroundings(const Image<float>& z_m, int bx, int by, int reach) {
  const float own_m = z_m.row(by)[bx];
  const int x0 = std::max(0, bx - reach), x1 = std::min(z_m.width() - 1, bx + reach);
  float nearest2 = static_cast<float>(reach * reach), behind_m = 0;
  for (int y = std::max(0, by - reach); y <= std::min(z_m.height() - 1, by + reach); ++y) {
    const float* row = z_m.row(y);
    const int dy2 = (y - by) * (y - by);
#pragma omp simd reduction(min : nearest2) reduction(max : behind_m)
    for (int x = x0; x <= x1; ++x) {
      const float ahead_m = own_m - row[x];
      const float distance2 = static_cast<float>((x - bx) * (x - bx) + dy2);
      const bool same = std::abs(ahead_m) < kPeopleStepM;
      nearest2 = std::min(nearest2, same ? nearest2 : distance2);
      behind_m = std::max(behind_m, same && ahead_m < kPeopleRadiusM ? ahead_m : 0.0F);
    }
  }
  return {std::sqrt(nearest2) - 0.5F, behind_m};
}

Ball ball_at(const Image<float>& z_m, const PinholeParams& view, int bx, int by) {
  const float own_m = z_m.row(by)[bx];
  if (!(own_m < kNobodyM)) return {};
  const float px_m = own_m / view.focal_px.x;
  const int reach = std::clamp(
      static_cast<int>(std::ceil(kPeopleRadiusM / (kBlockPx * px_m) + 0.5F)), 1, kMostBallBlocks);
  const float block_m = kBlockPx * px_m;
  const auto [blocks, behind_m] = surroundings(z_m, bx, by, reach);
  const float radius_m = std::max(std::min(kPeopleRadiusM - 0.5F * behind_m, blocks * block_m),
                                  kLeastBallBlocks * block_m);
  const float middle = 0.5F * (kBlockPx - 1);
  const glm::vec2 px(static_cast<float>(bx * kBlockPx) + middle,
                     static_cast<float>(by * kBlockPx) + middle);
  const glm::vec3 ray((px - view.center_px) / view.focal_px, 1);
  return {ray * own_m + radius_m * glm::normalize(ray), radius_m};
}

/// A ball in a lamp's map: a disc at the depth of its centre.
struct Disc {
  float u = 0, v = 0, radius = 0;  ///< texels
  float w = 0;                     ///< 1/m; 0: not drawn
};

Disc disc_of(const LampParams& lamp, const Ball& ball) {
  if (!(ball.radius_m > 0)) return {};
  const glm::vec3 p = transform(lamp.lamp_from_camera, ball.center_m);
  if (!(p.z > lamp.casters_near_m)) return {};
  const float scale = lamp.map_focal_texel / p.z;
  return {p.x * scale + lamp.map_center_texel, p.y * scale + lamp.map_center_texel,
          ball.radius_m * scale, 1 / p.z};
}

/// The border of a map stays empty.
int inner_texel(float texel, int size) {
  return static_cast<int>(std::clamp(texel, 1.0F, static_cast<float>(size - 1)));
}

/// Texels that the discs of all balls may touch, and the nearest of them.
Rect bounds_of(const LampParams& lamp, std::span<const Ball> balls, float& most_w) {
  const int size = lamp.map_size_texel;
  Rect rect{size, size, 0, 0};
  for (const Ball& ball : balls) {
    const Disc d = disc_of(lamp, ball);
    if (!(d.w > 0)) continue;
    rect = {std::min(rect.x0, inner_texel(d.u - d.radius, size)),
            std::min(rect.y0, inner_texel(d.v - d.radius, size)),
            std::max(rect.x1, inner_texel(d.u + d.radius + 2, size)),
            std::max(rect.y1, inner_texel(d.v + d.radius + 2, size))};
    most_w = std::max(most_w, d.w);
  }
  return rect.empty() ? Rect{} : rect;
}

/// Rows [y0, y1) of a disc.
void draw_disc(const Disc& d, int y0, int y1, Image<float>& map_w) {
  const int size = map_w.width();
  const int first = std::max(y0, inner_texel(std::ceil(d.v - d.radius), size));
  const int last = std::min(y1, inner_texel(std::floor(d.v + d.radius) + 1, size));
  for (int y = first; y < last; ++y) {
    const float dy = static_cast<float>(y) - d.v;
    const float half = std::sqrt(std::max(d.radius * d.radius - dy * dy, 0.0F));
    float* row = map_w.row(y);
    const int x1 = inner_texel(std::floor(d.u + half) + 1, size);
    for (int x = inner_texel(std::ceil(d.u - half), size); x < x1; ++x)
      row[x] = std::max(row[x], d.w);
  }
}

void draw_map(Crew& crew, std::span<const Ball> balls, LampParams& lamp, ShadowMap& map) {
  const int size = lamp.map_size_texel;
  if (map.w.width() != size) map.w.reset({size, size}), map.drawn = {};
  if (size == 0) return;
  for (int y = map.drawn.y0; y < map.drawn.y1; ++y)
    std::fill(map.w.row(y) + map.drawn.x0, map.w.row(y) + map.drawn.x1, 0.0F);
  float most_w = 0;
  map.drawn = bounds_of(lamp, balls, most_w);
  const int rows = map.drawn.y1 - map.drawn.y0, y0 = map.drawn.y0;
  crew.rows(rows, (rows + crew.threads() - 1) / crew.threads(), [&](int begin, int end) {
    for (const Ball& ball : balls)
      if (const Disc d = disc_of(lamp, ball); d.w > 0) draw_disc(d, y0 + begin, y0 + end, map.w);
  });
  // Penumbrae are looked for no farther than the nearest caster makes them.
  if (most_w > 0) lamp.casters_near_m = 1 / most_w;
  find_largest(map);
}

}  // namespace

PeopleShadow::PeopleShadow(Size view_size) {
  z_m.reset(
      {(view_size.width + kBlockPx - 1) / kBlockPx, (view_size.height + kBlockPx - 1) / kBlockPx});
  balls.resize(z_m.size().area());
}

void draw_people_maps(Crew& crew, const FrameParams& frame, const PinholeParams& view,
                      const Image<float>& view_w, const Image<std::uint8_t>& matte,
                      PeopleShadow& people) {
  const int columns = people.z_m.width(), rows = people.z_m.height();
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < columns; ++bx) people.z_m.row(by)[bx] = people_m(view_w, matte, bx, by);
  });
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < columns; ++bx)
        people.balls[static_cast<std::size_t>(by * columns + bx)] =
            ball_at(people.z_m, view, bx, by);
  });
  people.lamps = frame.people_lamps;
  people.maps.resize(people.lamps.size());
  for (std::size_t i = 0; i < people.maps.size(); ++i)
    draw_map(crew, people.balls, people.lamps[i], people.maps[i]);
}

}  // namespace mixrig::render::cpu
