// SPDX-License-Identifier: Apache-2.0
// Rows are first computed with plain arithmetic that the compiler vectorises; the few pixels with
// something unusual are then computed again one by one.
#include "host/render/cpu/plate/correct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hal/base/order_statistics.h"
#include "host/render/cpu/plate/stray_pieces.h"

namespace mixrig::render::cpu {
namespace {

using Stride = std::ptrdiff_t;

/// Offsets of a pixel's neighbours along the axes right, down, down-right, down-left.
constexpr std::array<Stride, 4> axes(Stride stride) { return {1, stride, stride + 1, stride - 1}; }

void z_row(const float* depth_m, const glm::vec2* ray, bool is_distance, int width, float* z_m) {
  for (int x = 0; x < width; ++x) {
    const float r2 = ray[x].x * ray[x].x + ray[x].y * ray[x].y;
    const float z = is_distance ? depth_m[x] / std::sqrt(1 + r2) : depth_m[x];
    z_m[x] = ((z > 0) & (z < kFarthestM) & (r2 >= 0)) ? z : 0;  // false for NaN too
  }
}

/// Distance of a pixel from the line through its neighbours, on the straightest axis: noise bends
/// all axes, an edge of the scene not the one along itself.
void bend_row(const float* z_m, Stride stride, int width, float* bend_m) {
  for (int x = 0; x < width; ++x) {
    const float* p = z_m + x;
    float least = std::numeric_limits<float>::max();
    bool any = false;
    for (const Stride d : axes(stride)) {
      const bool known = (p[-d] > 0) & (p[0] > 0) & (p[d] > 0);
      const float bend = std::abs(p[-d] - 2 * p[0] + p[d]);
      least = (known & (bend < least)) ? bend : least;
      any |= known;
    }
    bend_m[x] = any ? least : 0;
  }
}

void step_row(const CorrectParams& params, const float* z_m, const float* bend_m, Stride stride,
              int width, float* step_m) {
  const float sigmas = params.step_sigmas * std::sqrt(2.0F);
  for (int x = 0; x < width; ++x) {
    const float* p = bend_m + x;
    const float sum = p[-stride - 1] + p[-stride] + p[-stride + 1] + p[-1] + p[0] + p[1] +
                      p[stride - 1] + p[stride] + p[stride + 1];
    const float z = z_m[x];
    const float declared = sigmas * params.noise.sigma_m(z);
    const float found = params.step_bends / 9 * sum;
    const float by_noise = declared < kSteepest * z ? declared : kSteepest * z;
    const float by_bends = found < params.bends_part * z ? found : params.bends_part * z;
    const float step = by_noise > by_bends ? by_noise : by_bends;
    step_m[x] = step > params.step_min_m ? step : params.step_min_m;
  }
}

/// Whether three depths in line lie on one plane, to within a part of a step.
bool run_on(float a, float b, float c, float step_m) {
  if (!(a > 0 && b > 0 && c > 0)) return false;
  const float z = std::min(a, std::min(b, c));
  if (std::max(a, std::max(b, c)) > (1 + 2 * kSteepest) * z) return false;
  return std::abs(1 / a - 2 / b + 1 / c) * (z * z) <= kPlanePart * step_m;
}

/// Depth of the surface that fills most of a pixel which saw two; near1, near2, far1, far2: the
/// samples one and two pixels away on either side.
float owner_z(float z, float near1, float near2, float far1, float far2) {
  const float z_near = near2 > 0 ? std::min(near1, near2) : near1;
  const float z_far = std::max(far1, far2);
  const float share = (z_far - z) / (z_far - z_near);
  // Amplitudes fall with the square of the distance, so the near surface counts more.
  const float near_part = share * z_near * z_near, far_part = (1 - share) * z_far * z_far;
  return near_part >= far_part ? z_near : z_far;
}

/// Depth that a flying pixel gets; 0 if p does not fly.
float landed(const float* p, Stride stride, float step_m) {
  const float z = *p;
  for (const Stride d : axes(stride)) {
    const float before = p[-d], after = p[d];
    if (!(before > 0 && after > 0) || !((before - z) * (after - z) < 0)) continue;
    if (std::abs(before - z) <= step_m || std::abs(after - z) <= step_m) continue;
    if (run_on(z, before, p[-2 * d], step_m) || run_on(z, after, p[2 * d], step_m)) continue;
    return before < after ? owner_z(z, before, p[-2 * d], after, p[2 * d])
                          : owner_z(z, after, p[2 * d], before, p[-2 * d]);
  }
  return 0;
}

/// Whether at least two neighbours lie at p's depth, or three depths in line run through it.
bool is_supported(const float* p, Stride stride, float step_m) {
  int supporters = 0;
  for (const Stride d : axes(stride))
    for (const Stride side : {-d, d}) {
      supporters += p[side] > 0 && std::abs(p[side] - *p) <= step_m;
      if (run_on(*p, p[side], p[2 * side], step_m)) return true;
    }
  return supporters >= kLeastSupporters;
}

/// Median of the known among the eight neighbours; 0 for fewer than kLeastKnown.
float median_around(const float* p, Stride stride) {
  std::array<float, 8> known{};
  std::size_t count = 0;
  for (const Stride d : axes(stride))
    for (const Stride side : {-d, d})
      if (p[side] > 0) known[count++] = p[side];
  if (count < kLeastKnown) return 0;
  return upper_median_in_place(std::span(known.data(), count));
}

float clean(const float* p, Stride stride, float step_m) {
  if (*p > 0) {
    const float z = landed(p, stride, step_m);
    if (z > 0) return z;
    if (is_supported(p, stride, step_m)) return *p;
  }
  return median_around(p, stride);
}

void clean_row(const float* raw_m, const float* step_m, Stride stride, int width, float* z_m) {
  for (int x = 0; x < width; ++x) {
    const float* p = raw_m + x;
    int supporters = 0;
    bool may_fly = false;
    for (const Stride d : axes(stride)) {
      const float before = p[-d] - p[0], after = p[d] - p[0];
      const bool near_before = std::abs(before) <= step_m[x],
                 near_after = std::abs(after) <= step_m[x];
      supporters += (p[-d] > 0) & near_before;
      supporters += (p[d] > 0) & near_after;
      may_fly |= (before * after < 0) & !near_before & !near_after;
    }
    z_m[x] = ((p[0] > 0) & (supporters >= kLeastSupporters) & !may_fly) ? p[0] : -1;
  }
  for (int x = 0; x < width; ++x)
    if (z_m[x] < 0) z_m[x] = clean(raw_m + x, stride, step_m[x]);
}

/// Mean of inverse depth over neighbours within half a step, and over pairs of opposite ones within
/// a step: one side alone would bias a sloping surface.
void smooth_row(const float* clean_m, const float* step_m, Stride stride, int width, float* z_m,
                float* w) {
  for (int x = 0; x < width; ++x) {
    const float* p = clean_m + x;
    const bool known = p[0] > 0;
    float sum = known ? 1 / p[0] : 0, count = 1;
    for (const Stride d : axes(stride)) {
      const float before = std::abs(p[-d] - p[0]), after = std::abs(p[d] - p[0]);
      const float limit =
          ((before <= step_m[x]) & (after <= step_m[x])) ? step_m[x] : kSmoothPart * step_m[x];
      const bool joins_before = (before <= limit) & (p[-d] > 0);
      const bool joins_after = (after <= limit) & (p[d] > 0);
      sum += (joins_before ? 1 / p[-d] : 0) + (joins_after ? 1 / p[d] : 0);
      count += (joins_before ? 1.0F : 0.0F) + (joins_after ? 1.0F : 0.0F);
    }
    w[x] = known ? sum / count : 0;
    z_m[x] = known ? count / sum : 0;
  }
}

bool linked(const float* p, const float* step_m, Stride d) {
  const float a = p[0], b = p[d];
  if (!(a > 0 && b > 0)) return false;
  const float step = std::min(step_m[0], step_m[d]);
  return std::abs(a - b) <= step || (run_on(p[-d], a, b, step) && run_on(a, b, p[2 * d], step));
}

void link_row(const float* z_m, const float* step_m, Stride stride, int width, float step_min_m,
              std::uint8_t* links) {
  constexpr std::uint8_t kAllLinks = kRight | kDown | kDownRight | kDownLeft;
  for (int x = 0; x < width; ++x) {
    const float* p = z_m + x;
    bool all = p[0] > 0;
    for (const Stride d : axes(stride)) all &= (std::abs(p[d] - p[0]) <= step_min_m) & (p[d] > 0);
    links[x] = all ? kAllLinks : 0;
  }
  for (int x = 0; x < width; ++x) {
    if (links[x] == kAllLinks || !(z_m[x] > 0)) continue;
    for (std::size_t i = 0; i < 4; ++i)
      if (linked(z_m + x, step_m + x, axes(stride)[i]))
        links[x] |= static_cast<std::uint8_t>(1U << i);
  }
}

}  // namespace

TofGrid::TofGrid(Size tof_size) {
  const Size framed{tof_size.width + 2 * kFrame, tof_size.height + 2 * kFrame};
  for (Image<float>* image : {&raw_z_m, &bend_m, &step_m, &clean_z_m, &z_m, &w})
    image->reset(framed);
  links.reset(framed);
}

void correct(Crew& crew, const CorrectParams& params, const Image<glm::vec2>& tof_ray,
             ImageView<const float> depth_m, TofGrid& grid) {
  correct_depth(crew, params, tof_ray, depth_m, grid);
  link_pixels(crew, params, grid.z_m, grid);
}

namespace {

/// Pointer to the first pixel of a row of a framed image.
template <typename T>
auto* inner(T& image, int y) {
  return image.row(y + kFrame) + kFrame;
}

template <typename Row>
void sweep(Crew& crew, int height, Row&& do_row) {
  crew.rows(height, 32, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) do_row(y);
  });
}

}  // namespace

void correct_depth(Crew& crew, const CorrectParams& params, const Image<glm::vec2>& tof_ray,
                   ImageView<const float> depth_m, TofGrid& grid) {
  const int width = depth_m.size.width, height = depth_m.size.height;
  const Stride stride = grid.z_m.stride();  // the same for all float grids
  sweep(crew, height, [&](int y) {
    z_row(depth_m.row(y), tof_ray.row(y), params.depth_is_distance, width, inner(grid.z_m, y));
  });
  sweep(crew, height, [&](int y) {
    drop_stray_pieces(params, inner(grid.z_m, y), stride, y, depth_m.size, inner(grid.raw_z_m, y));
  });
  sweep(crew, height,
        [&](int y) { bend_row(inner(grid.raw_z_m, y), stride, width, inner(grid.bend_m, y)); });
  sweep(crew, height, [&](int y) {
    step_row(params, inner(grid.raw_z_m, y), inner(grid.bend_m, y), stride, width,
             inner(grid.step_m, y));
    clean_row(inner(grid.raw_z_m, y), inner(grid.step_m, y), stride, width,
              inner(grid.clean_z_m, y));
  });
  sweep(crew, height, [&](int y) {
    smooth_row(inner(grid.clean_z_m, y), inner(grid.step_m, y), stride, width, inner(grid.z_m, y),
               inner(grid.w, y));
  });
}

void link_pixels(Crew& crew, const CorrectParams& params, const Image<float>& z_m, TofGrid& grid) {
  const int width = z_m.width() - 2 * kFrame, height = z_m.height() - 2 * kFrame;
  sweep(crew, height, [&](int y) {
    link_row(inner(z_m, y), inner(grid.step_m, y), z_m.stride(), width, params.step_min_m,
             inner(grid.links, y));
  });
}

}  // namespace mixrig::render::cpu
