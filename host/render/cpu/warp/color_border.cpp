// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/warp/color_border.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

using Colors = std::array<glm::vec3, kBorderSamples>;

/// Linear light at a place within the picture.
glm::vec3 bilinear(const Image<Rgbx16>& plate, glm::vec2 at) {
  const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
  const int right = x + 1 < plate.width() ? x + 1 : x, below = y + 1 < plate.height() ? y + 1 : y;
  const glm::vec2 part = at - glm::vec2(x, y);
  const auto light = [&](int i, int j) {
    const Rgbx16 c = plate.row(j)[i];
    return glm::vec3(c.r, c.g, c.b);
  };
  const glm::vec3 upper = glm::mix(light(x, y), light(right, y), part.x);
  const glm::vec3 lower = glm::mix(light(x, below), light(right, below), part.x);
  return glm::mix(upper, lower, part.y) * (1 / kLinearOne);
}

/// Roots of linear light at the kBorderSamples places along a link at the nearer sample's depth, a
/// quarter of a ToF pixel apart; the third is at the nearer sample.
Colors colors_along(const WarpParams& p, const Image<Rgbx16>& plate, glm::vec2 ray,
                    glm::vec2 half_step, float w) {
  const glm::mat3 turn(p.camera_from_tof);
  const glm::vec3 first =
      turn * glm::vec3(ray - half_step, 1) + glm::vec3(p.camera_from_tof[3]) * w;
  const glm::vec3 step = turn * glm::vec3(0.5F * half_step, 0);
  const glm::vec2 last(plate.width() - 1, plate.height() - 1);
  Colors out;
  glm::vec3 q = first;
  for (glm::vec3& color : out) {
    const glm::vec2 at = p.view.focal_px * glm::vec2(q) / std::max(q.z, 1e-6F) + p.view.center_px;
    color = glm::sqrt(bilinear(plate, glm::clamp(at, glm::vec2(0), last)));
    q += step;
  }
  return out;
}

/// Finds the border: each side's colour is the mean of two samples at its end; the share of the
/// nearer side in each sample follows from both, as in the matte; the sum of the shares is the
/// border's place.
ColorBorder border_of(const Colors& colors) {
  const glm::vec3 near = 0.5F * (colors[0] + colors[1]);
  const glm::vec3 far = 0.5F * (colors[kBorderSamples - 2] + colors[kBorderSamples - 1]);
  const glm::vec3 spread = colors[0] - near, far_spread = colors[kBorderSamples - 1] - far;
  const float sigma2 = kBorderSpread2 + glm::dot(spread, spread) + glm::dot(far_spread, far_spread);
  const glm::vec3 apart = near - far;
  const float apart2 = glm::dot(apart, apart), over = 1 / std::max(apart2, 1e-6F);
  float sum = 0, off2 = 0;
  for (std::size_t i = 1; i < kBorderSamples; ++i) {
    const glm::vec3 from_far = colors[i] - far;
    const float share = over * glm::dot(from_far, apart);
    const glm::vec3 rest = from_far - share * apart;
    off2 += glm::dot(rest, rest);
    sum += std::clamp(share, 0.0F, 1.0F);
  }
  const float one_off2 = off2 / (kBorderSamples - 1);
  const float line2 = sigma2 + kBorderBent2 * apart2;
  const float sure =
      apart2 / (apart2 + kBorderApart * kBorderApart * sigma2) * line2 / (line2 + one_off2);
  return {0.5F * sum - 0.75F, sure};
}

/// Border on the link from (x, y) to (x + dx, y + dy), which does not hold.
ColorBorder find_border(const WarpParams& params, const Image<glm::vec2>& tof_ray,
                        const TofGrid& grid, const Image<Rgbx16>& plate, int x, int y, int dx,
                        int dy) {
  const DepthsAtBorder z = depths_at_border(grid, x, y, dx, dy);
  const bool here = z.own_m > 0 && (z.own_m < z.other_m || !(z.other_m > 0));
  const float near_m = here ? z.own_m : z.other_m, far_m = here ? z.other_m : z.own_m;
  if (!(near_m > 0) || (far_m > 0 && far_m - near_m < kSharePartOfDepth * near_m)) return {};
  const glm::vec2 own = tof_ray.row(y)[x], other = tof_ray.row(y + dy)[x + dx];
  const glm::vec2 ray = here ? own : other, half_step = 0.5F * (here ? other - own : own - other);
  if (std::isnan(half_step.x)) return {};
  return border_of(colors_along(params, plate, ray, half_step, 1 / near_m));
}

}  // namespace

DepthsAtBorder depths_at_border(const TofGrid& grid, int x, int y, int dx, int dy) {
  const std::ptrdiff_t step = dx + dy * grid.w.stride();
  const float* w = grid.w.row(y + kFrame) + x + kFrame;
  const float own = linked(grid, x, y, -dx, -dy) ? w[-step] : w[0];
  const float other = linked(grid, x + dx, y + dy, dx, dy) ? w[2 * step] : w[step];
  return {w[0] > 0 ? 1 / own : 0, w[step] > 0 ? 1 / other : 0};
}

void find_color_borders(Crew& crew, const WarpParams& params, const Image<glm::vec2>& tof_ray,
                        const TofGrid& grid, const Image<Rgbx16>& plate, ColorBorders& out) {
  constexpr int kGrain = 8;
  const int width = tof_ray.width(), height = tof_ray.height();
  crew.rows(height, kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      const float* w = grid.w.row(y + kFrame) + kFrame;
      const float* below = w + grid.w.stride();
      for (int x = 0; x < width; ++x) {
        const auto find = [&](float other_w, int dx, int dy, Image<ColorBorder>& to) {
          if ((w[x] > 0 || other_w > 0) && !linked(grid, x, y, dx, dy))
            to.row(y)[x] = find_border(params, tof_ray, grid, plate, x, y, dx, dy);
        };
        if (x + 1 < width) find(w[x + 1], 1, 0, out.right);
        if (y + 1 < height) find(below[x], 0, 1, out.down);
      }
    }
  });
}

}  // namespace mixrig::render::cpu
