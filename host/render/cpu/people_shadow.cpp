// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/people_shadow.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

/// Mean inverse depth of a block's people; 0 where they fill less than half of it.
float people_w(const Image<float>& view_w, const Image<std::uint8_t>& matte, int bx, int by) {
  const int x1 = std::min((bx + 1) * kBlockPx, matte.width());
  const int y1 = std::min((by + 1) * kBlockPx, matte.height());
  float sum = 0;
  int count = 0, pixels = 0;
  for (int y = by * kBlockPx; y < y1; ++y)
    for (int x = bx * kBlockPx; x < x1; ++x) {
      ++pixels;
      if (matte.row(y)[x] < kPersonByte || !(view_w.row(y)[x] > 0)) continue;
      sum += view_w.row(y)[x];
      ++count;
    }
  return 2 * count >= pixels && count > 0 ? sum / static_cast<float>(count) : 0;
}

/// Blocks from the middle of (bx, by) to the nearest one that shows another surface, less half of
/// one; a person goes on past the border of the view.
float blocks_to_silhouette(const Image<float>& w, int bx, int by, int reach) {
  const float own_m = 1 / w.row(by)[bx];
  int nearest2 = reach * reach;
  for (int y = std::max(0, by - reach); y <= std::min(w.height() - 1, by + reach); ++y)
    for (int x = std::max(0, bx - reach); x <= std::min(w.width() - 1, bx + reach); ++x) {
      const float other_w = w.row(y)[x];
      const bool same = other_w > 0 && std::abs(1 / other_w - own_m) < kPeopleStepM;
      const int distance2 = (x - bx) * (x - bx) + (y - by) * (y - by);
      if (!same) nearest2 = std::min(nearest2, distance2);
    }
  return std::sqrt(static_cast<float>(nearest2)) - 0.5F;
}

Ball ball_at(const Image<float>& w, const PinholeParams& view, int bx, int by) {
  const float own_w = w.row(by)[bx];
  if (!(own_w > 0)) return {};
  const float px_m = 1 / (own_w * view.focal_px.x);
  const int reach = std::clamp(
      static_cast<int>(std::ceil(kPeopleRadiusM / (kBlockPx * px_m) + 0.5F)), 1, kMostBallBlocks);
  const float block_m = kBlockPx * px_m;
  const float radius_m =
      std::max(std::min(kPeopleRadiusM, blocks_to_silhouette(w, bx, by, reach) * block_m),
               kLeastBallBlocks * block_m);
  const float middle = 0.5F * (kBlockPx - 1);
  const glm::vec2 px(static_cast<float>(bx * kBlockPx) + middle,
                     static_cast<float>(by * kBlockPx) + middle);
  const glm::vec3 ray((px - view.center_px) / view.focal_px, 1);
  return {ray / own_w + radius_m * glm::normalize(ray), radius_m};
}

/// Rows [y0, y1) of a disc at the depth of the ball's centre.
void draw_ball(const LampParams& lamp, const Ball& ball, int y0, int y1, Image<float>& map_w) {
  const glm::vec3 p = transform(lamp.lamp_from_camera, ball.center_m);
  if (!(p.z > lamp.casters_near_m)) return;
  const float scale = lamp.map_focal_texel / p.z, w = 1 / p.z;
  const float u = p.x * scale + lamp.map_center_texel, v = p.y * scale + lamp.map_center_texel;
  const float radius = ball.radius_m * scale;
  // The border of a map stays empty.
  const float last = static_cast<float>(map_w.width() - 2);
  const auto whole = [last](float texel) {
    return static_cast<int>(std::clamp(texel, 1.0F, last + 1));
  };
  for (int y = std::max(y0, whole(std::ceil(v - radius)));
       y < std::min(y1, whole(std::floor(v + radius) + 1)); ++y) {
    const float dy = static_cast<float>(y) - v;
    const float half = std::sqrt(std::max(radius * radius - dy * dy, 0.0F));
    float* row = map_w.row(y);
    const int x1 = whole(std::floor(u + half) + 1);
    for (int x = whole(std::ceil(u - half)); x < x1; ++x) row[x] = std::max(row[x], w);
  }
}

}  // namespace

PeopleShadow::PeopleShadow(Size view_size) {
  w.reset(
      {(view_size.width + kBlockPx - 1) / kBlockPx, (view_size.height + kBlockPx - 1) / kBlockPx});
  balls.resize(w.size().area());
}

void draw_people_maps(Crew& crew, const FrameParams& frame, const PinholeParams& view,
                      const Image<float>& view_w, const Image<std::uint8_t>& matte,
                      PeopleShadow& people) {
  const int columns = people.w.width(), rows = people.w.height();
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < columns; ++bx) people.w.row(by)[bx] = people_w(view_w, matte, bx, by);
  });
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < columns; ++bx)
        people.balls[static_cast<std::size_t>(by * columns + bx)] = ball_at(people.w, view, bx, by);
  });
  people.maps.resize(frame.people_lamps.size());
  for (std::size_t i = 0; i < people.maps.size(); ++i) {
    const LampParams& lamp = frame.people_lamps[i];
    const int size = lamp.map_size_texel;
    Image<float>& map_w = people.maps[i].w;
    if (map_w.width() != size) map_w.reset({size, size});
    if (size == 0) continue;
    map_w.fill(0);
    crew.rows(size, (size + crew.threads() - 1) / crew.threads(), [&](int begin, int end) {
      for (const Ball& ball : people.balls)
        if (ball.radius_m > 0) draw_ball(lamp, ball, begin, end, map_w);
    });
  }
  crew.rows(static_cast<int>(people.maps.size()), 1, [&](int begin, int) {
    ShadowMap& map = people.maps[static_cast<std::size_t>(begin)];
    if (!map.empty()) find_largest(map);
  });
}

}  // namespace mixrig::render::cpu
