// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/people_shadow.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "host/render/cpu/light/light_parts.h"

namespace mixrig::render::cpu {
namespace {

/// Depth of blocks without people, farther than anybody.
constexpr float kNobodyM = 1e9F;
/// Factor on a ball's radius: by perspective, the disc of a ball inside another one may reach out
/// of that one's disc.
constexpr float kDiscSlack = 1.25F;
/// People nearer to a lamp are ignored.
constexpr float kNearestToLampM = 0.01F;

/// Depth of a block's people, the inverse of their mean w; kNobodyM if they fill less than half of
/// it.
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
  /// Distance to the nearest block of another surface, less half a block.
  float blocks_to_silhouette = 0;
  /// How far the nearest part of the same body lies before it; parts nearer by more are limbs.
  float behind_m = 0;
};

/// Surroundings of the middle of block (bx, by). Beyond the border of the view a person continues.
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

/// Disc of a ball in a lamp's map, at the depth of its centre.
struct Disc {
  float u = 0, v = 0, radius = 0;  ///< texels
  float w = 0;                     ///< 1/m; 0: not drawn
};

Disc disc_of(const LampParams& lamp, const Ball& ball, float near_m) {
  const glm::vec3 p = transform(lamp.lamp_from_camera, ball.center_m);
  if (!(p.z > near_m)) return {};
  const float scale = lamp.map_focal_texel / p.z, radius = ball.radius_m * scale;
  const float u = p.x * scale + lamp.map_center_texel, v = p.y * scale + lamp.map_center_texel;
  // The border of a map stays empty.
  const float last = static_cast<float>(lamp.map_size_texel - 2);
  const bool beside = std::min(u, v) + radius < 1 || std::max(u, v) - radius > last;
  return {u, v, radius, beside ? 0 : 1 / p.z};
}

/// Whether some lamp's map may show the ball, or another ball within it.
bool in_any_map(std::span<const LampParams> lamps, Ball ball) {
  ball.radius_m *= kDiscSlack;
  return std::any_of(lamps.begin(), lamps.end(), [&](const LampParams& lamp) {
    const float near_m = std::max(lamp.casters_near_m - ball.radius_m, kNearestToLampM);
    return lamp.map_size_texel > 0 && disc_of(lamp, ball, near_m).w > 0;
  });
}

Ball ball_at(std::span<const LampParams> lamps, const Image<float>& z_m, const PinholeParams& view,
             int bx, int by) {
  const float own_m = z_m.row(by)[bx];
  if (!(own_m < kNobodyM)) return {};
  const float block_m = kBlockPx * own_m / view.focal_px.x;
  const bool small = block_m < kSmallBlockM;
  if (small && ((bx | by) & 1) != 0) return {};
  const int reach =
      std::clamp(static_cast<int>(std::ceil(kPeopleRadiusM / block_m + 0.5F)), 1, kMostBallBlocks);
  const float middle = 0.5F * (kBlockPx - 1);
  const glm::vec2 px(static_cast<float>(bx * kBlockPx) + middle,
                     static_cast<float>(by * kBlockPx) + middle);
  const glm::vec3 ray((px - view.center_px) / view.focal_px, 1);
  const auto ball = [&](float radius_m) {
    return Ball{ray * own_m + radius_m * glm::normalize(ray), radius_m};
  };
  const float least_m = kLeastBallBlocks * (small ? 2 : 1) * block_m;
  if (!in_any_map(lamps, ball(std::max(kPeopleRadiusM, least_m)))) return {};
  const auto [blocks, behind_m] = surroundings(z_m, bx, by, reach);
  return ball(std::max(std::min(kPeopleRadiusM - 0.5F * behind_m, blocks * block_m), least_m));
}

/// Clamps a texel so that the border of a map stays empty.
int inner_texel(float texel, int size) {
  return static_cast<int>(std::clamp(texel, 1.0F, static_cast<float>(size - 1)));
}

/// Texels that the discs of all balls may touch, and the largest w of the balls.
Rect bounds_of(const LampParams& lamp, std::span<const Ball> balls, float& most_w) {
  const int size = lamp.map_size_texel;
  Rect rect{size, size, 0, 0};
  for (const Ball& ball : balls) {
    const Disc d = disc_of(lamp, ball, lamp.casters_near_m);
    if (!(d.w > 0)) continue;
    rect = {std::min(rect.x0, inner_texel(d.u - d.radius, size)),
            std::min(rect.y0, inner_texel(d.v - d.radius, size)),
            std::max(rect.x1, inner_texel(d.u + d.radius + 2, size)),
            std::max(rect.y1, inner_texel(d.v + d.radius + 2, size))};
    most_w = std::max(most_w, d.w);
  }
  return rect.empty() ? Rect{} : rect;
}

/// Draws rows [y0, y1) of a disc.
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
  if (map.w.width() != size) map.w.reset({size, size}), map.drawn = {}, map.largest.clear();
  if (size == 0) return;
  const bool was_empty = map.drawn.empty() && !map.largest.empty();
  for (int y = map.drawn.y0; y < map.drawn.y1; ++y)
    std::fill(map.w.row(y) + map.drawn.x0, map.w.row(y) + map.drawn.x1, 0.0F);
  float most_w = 0;
  map.drawn = bounds_of(lamp, balls, most_w);
  const int rows = map.drawn.y1 - map.drawn.y0, y0 = map.drawn.y0;
  if (rows == 0) {
    if (!was_empty) find_largest(map);
    return;
  }
  crew.rows(rows, (rows + crew.threads() - 1) / crew.threads(), [&](int begin, int end) {
    for (const Ball& ball : balls)
      if (const Disc d = disc_of(lamp, ball, lamp.casters_near_m); d.w > 0)
        draw_disc(d, y0 + begin, y0 + end, map.w);
  });
  // The search for casters then reaches no farther than the nearest one requires.
  lamp.casters_near_m = 1 / most_w;
  find_largest(map);
}

}  // namespace

PeopleShadow::PeopleShadow(Size view_size) {
  z_m.reset(
      {(view_size.width + kBlockPx - 1) / kBlockPx, (view_size.height + kBlockPx - 1) / kBlockPx});
  balls.resize(z_m.size().area());
  drawn.reserve(balls.size());
}

void draw_people_maps(Crew& crew, const FrameParams& frame, const PinholeParams& view,
                      const Image<float>& view_w, const Image<std::uint8_t>& matte,
                      PeopleShadow& people) {
  const int columns = people.z_m.width(), rows = people.z_m.height();
  people.lamps = frame.people_lamps;
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < columns; ++bx) people.z_m.row(by)[bx] = people_m(view_w, matte, bx, by);
  });
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < columns; ++bx)
        people.balls[static_cast<std::size_t>(by * columns + bx)] =
            ball_at(people.lamps, people.z_m, view, bx, by);
  });
  people.drawn.clear();
  for (const Ball& ball : people.balls)
    if (ball.radius_m > 0) people.drawn.push_back(ball);
  people.maps.resize(people.lamps.size());
  people.reach = 0;
  for (std::size_t i = 0; i < people.maps.size(); ++i) {
    draw_map(crew, people.drawn, people.lamps[i], people.maps[i]);
    if (!people.maps[i].drawn.empty()) people.reach |= i < kLampBits ? LampSet{1} << i : kAllLamps;
  }
  find_people_grid(crew, frame.people_grid, people.lamps, people.maps, people.reach, people.grid);
}

}  // namespace mixrig::render::cpu
