// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/mix/motion.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

constexpr int kMotionGrain = 8;

bool is_within(const Rect& r, int x, int y) {
  return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
}

/// Premultiplied colour (65535 = 1) and coverage (255 = 1) of a pixel.
glm::vec4 layer_at(const VirtualLayer& from, int x, int y) {
  if (!is_within(from.rect, x, y)) return glm::vec4(0);
  const std::uint8_t coverage = from.coverage.row(y)[x];
  if (coverage == 0) return glm::vec4(0);
  const Rgbx16 c = from.color.row(y)[x];
  return {c.r, c.g, c.b, coverage};
}

glm::vec4 layer_between(const VirtualLayer& from, const glm::vec2& at) {
  const glm::vec2 base = glm::floor(at), t = at - base;
  const int x = static_cast<int>(base.x), y = static_cast<int>(base.y);
  const glm::vec4 top = glm::mix(layer_at(from, x, y), layer_at(from, x + 1, y), t.x);
  const glm::vec4 bottom = glm::mix(layer_at(from, x, y + 1), layer_at(from, x + 1, y + 1), t.x);
  return glm::mix(top, bottom, t.y);
}

float part_of_way(int i, int samples) {
  return (static_cast<float>(i) + 0.5F) / static_cast<float>(samples) - 0.5F;
}

/// Inverse depth of the nearest object that passes the pixel, 1/m; 0 if none does.
float passing_w(const MotionParams& params, const VirtualLayer& from, int x, int y) {
  if (is_within(from.rect, x, y) && from.coverage.row(y)[x] > 0) return from.w.row(y)[x];
  const glm::vec2 at(x, y), way = motion_px(params, at, params.nearest_w);
  const int samples = motion_samples(glm::length(way));
  float w = 0;
  for (int i = 0; i < samples; ++i) {
    const glm::vec2 met = glm::floor(at + part_of_way(i, samples) * way + 0.5F);
    const int u = static_cast<int>(met.x), v = static_cast<int>(met.y);
    if (is_within(from.rect, u, v) && from.coverage.row(v)[u] > 0)
      w = std::max(w, from.w.row(v)[u]);
  }
  return w;
}

std::uint16_t rounded_16(float v) {
  return static_cast<std::uint16_t>(std::min(v, kLinearOne) + 0.5F);
}

void blur_row(const MotionParams& params, const VirtualLayer& from, int y, VirtualLayer& to) {
  for (int x = to.rect.x0; x < to.rect.x1; ++x) {
    to.coverage.row(y)[x] = 0;
    const float w = passing_w(params, from, x, y);
    if (!(w > 0)) continue;
    const glm::vec2 at(x, y), way = motion_px(params, at, w);
    const int samples = motion_samples(glm::length(way));
    glm::vec4 sum(0);
    for (int i = 0; i < samples; ++i)
      sum += layer_between(from, at + part_of_way(i, samples) * way);
    sum *= 1 / static_cast<float>(samples);
    const auto coverage = static_cast<std::uint8_t>(std::min(sum.w, 255.0F) + 0.5F);
    if (coverage == 0) continue;
    to.coverage.row(y)[x] = coverage;
    to.color.row(y)[x] = {rounded_16(sum.x), rounded_16(sum.y), rounded_16(sum.z), 0};
    to.w.row(y)[x] = w;
  }
}

}  // namespace

void blur_by_motion(Crew& crew, const MotionParams& params, const VirtualLayer& from,
                    VirtualLayer& to) {
  for (int y = to.rect.y0; y < to.rect.y1; ++y)
    std::fill(to.coverage.row(y) + to.rect.x0, to.coverage.row(y) + to.rect.x1, 0);
  to.rect = params.rect;
  crew.rows(to.rect.y1 - to.rect.y0, kMotionGrain, [&](int begin, int end) {
    for (int y = to.rect.y0 + begin; y < to.rect.y0 + end; ++y) blur_row(params, from, y, to);
  });
}

}  // namespace mixrig::render::cpu
