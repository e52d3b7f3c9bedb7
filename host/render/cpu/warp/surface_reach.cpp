// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/warp/surface_reach.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

/// Place in the view, px from its centre; (0, 0) if the point is not before the camera.
glm::vec2 place_px(const WarpParams& p, glm::vec2 ray, float w) {
  const glm::vec3 q =
      glm::mat3(p.camera_from_tof) * glm::vec3(ray, 1) + glm::vec3(p.camera_from_tof[3]) * w;
  return q.z > 0 ? p.view.focal_px * glm::vec2(q) / q.z : glm::vec2(0);
}

/// Share of the nearer surface in a ToF pixel at a step, from its measurement z_m: `pure` if it saw
/// one surface, or a depth that is neither of them nor between.
float near_share(float z_m, float near_m, float far_m, float pure) {
  if (!(z_m > 0)) return kHoleShare;
  const float by_phase = (far_m - z_m) / (far_m - near_m);
  if (by_phase < -kShareSlack || by_phase > 1 + kShareSlack) return pure;
  // Amplitudes fall with the square of the distance.
  const float part = std::clamp(by_phase, 0.0F, 1.0F);
  const float by_near = part * near_m * near_m, by_far = (1 - part) * far_m * far_m;
  const float share = by_near / (by_near + by_far);
  return std::abs(share - pure) < kMixedShare ? pure : share;
}

/// By how much the border of the nearer surface lies farther out than midway between two samples,
/// in halves of a ToF pixel. `near_z_m`, `far_z_m`: what the pixels on either side measured.
float border_shift(float near_m, float far_m, float near_z_m, float far_z_m) {
  if (far_m - near_m < kSharePartOfDepth * near_m) return 0;
  return 2 * (near_share(near_z_m, near_m, far_m, 1) + near_share(far_z_m, near_m, far_m, 0) - 1);
}

/// Whether two neighbours along x or y are linked.
bool linked(const TofGrid& grid, int x, int y, int dx, int dy) {
  const int from_x = dx < 0 ? x - 1 : x, from_y = dy < 0 ? y - 1 : y;
  return grid.links.row(from_y + kFrame)[from_x + kFrame] & (dx != 0 ? kRight : kDown);
}

}  // namespace

/// Extension towards a farther neighbour, by whether the view sees a gap or an overlap at the
/// border.
float SurfaceReach::by_sight(int x, int y, int dx, int dy, float w, float other_w) const {
  const glm::vec2 ray = tof_ray_.row(y)[x], other = tof_ray_.row(y + dy)[x + dx];
  const glm::vec2 border_ray = std::isnan(other.x) ? ray : ray + 0.5F * (other - ray);
  const glm::vec2 border = place_px(params_, border_ray, w),
                  out = border - place_px(params_, ray, w);
  const float length = std::max(glm::length(out), 1e-6F);
  const float opens_px = glm::dot(place_px(params_, border_ray, other_w) - border, out) / length;
  const float part = std::min(1.0F, std::abs(opens_px) / kReachRampPx);
  return 1 + part * ((opens_px > 0 ? params_.open_reach : params_.shut_reach) - 1);
}

float SurfaceReach::towards(int x, int y, int dx, int dy) const {
  if (linked(grid_, x, y, dx, dy)) return 1;
  const std::ptrdiff_t step = dx + dy * grid_.w.stride();
  const float* w = grid_.w.row(y + kFrame) + x + kFrame;
  const float other_w = w[step];
  const float sight = other_w >= *w ? 1 : by_sight(x, y, dx, dy, *w, other_w);
  if (!params_.mixed_pixels || !(other_w > 0)) return sight;
  // Depths by the samples behind, which saw one surface each.
  const float own_m = 1 / (linked(grid_, x, y, -dx, -dy) ? w[-step] : *w);
  const float other_m = 1 / (linked(grid_, x + dx, y + dy, dx, dy) ? w[2 * step] : other_w);
  const float* raw_m = grid_.raw_z_m.row(y + kFrame) + x + kFrame;
  const float shift = own_m < other_m ? border_shift(own_m, other_m, raw_m[0], raw_m[step])
                                      : -border_shift(other_m, own_m, raw_m[step], raw_m[0]);
  return std::clamp(sight + shift, 0.0F, kMostReach);
}

}  // namespace mixrig::render::cpu
