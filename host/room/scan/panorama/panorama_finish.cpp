// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/panorama_finish.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "hal/base/order_statistics.h"

namespace mixrig::model {
namespace {

constexpr float kNoise = 3;  ///< sigmas

/// The median, where two thirds of the distances lie within `gate_m` of it; else 0. Reorders them.
float shared_by_most(std::span<float> all_m, float gate_m) {
  constexpr std::size_t kLeastKnown = 12;
  if (all_m.size() < kLeastKnown) return 0;
  const float median_m = upper_median_in_place(all_m);
  const auto agree = std::count_if(all_m.begin(), all_m.end(),
                                   [&](float d_m) { return std::abs(d_m - median_m) < gate_m; });
  return 3 * static_cast<std::size_t>(agree) >= 2 * all_m.size() ? median_m : 0;
}

}  // namespace

void smooth_rows(const Panorama& before, Panorama& p, int begin, int end) {
  constexpr int kReach_px = 3, kWidest_px = 24;
  const Size size = before.size();
  const double pixel_rad = std::numbers::pi / size.height;
  std::vector<float> pairs_m;
  for (int y = begin; y < end; ++y) {
    const double across = std::sin(std::numbers::pi * (y + 0.5) / size.height);
    const int reach_x =
        std::min(kWidest_px, static_cast<int>(std::lround(kReach_px / std::max(across, 0.01))));
    const int step_x = std::max(1, reach_x / kReach_px);
    for (int x = 0; x < size.width; ++x) {
      const float here_m = before.distance_m.row(y)[x], sigma_m = before.sigma_m.row(y)[x];
      if (before.views.row(y)[x] == 0) continue;
      float weight = 0, sum = 0;
      pairs_m.clear();
      bool alone = true;  // no pair agrees
      for (int dy = -kReach_px; dy <= kReach_px; ++dy) {
        const int up = y - dy, down = y + dy;  // pairs opposite each other keep a slope
        if (up < 0 || down < 0 || up >= size.height || down >= size.height) continue;
        for (int dx = -reach_x; dx <= reach_x; dx += step_x) {
          const int left = (x - dx + size.width) % size.width,
                    right = (x + dx + size.width) % size.width;
          const float a_m = before.distance_m.row(up)[left],
                      b_m = before.distance_m.row(down)[right];
          if (a_m <= 0 || b_m <= 0) continue;
          const double right_rad = pixel_rad * across * dx, up_rad = pixel_rad * dy;
          const auto longer =
              static_cast<float>(1 + 0.5 * (right_rad * right_rad + up_rad * up_rad));  // 1 / cos
          const float mean = 0.5F * longer * (1 / a_m + 1 / b_m);
          if (dx != 0 || dy != 0) pairs_m.push_back(1 / mean);
          if (std::abs(1 / mean - here_m) > kNoise * sigma_m) continue;
          const float sa_m = before.sigma_m.row(up)[left], sb_m = before.sigma_m.row(down)[right];
          const float w = 1 / (sa_m * sa_m + sb_m * sb_m);
          weight += w, sum += w * mean;
          alone = alone && dx == 0 && dy == 0;
        }
      }
      const float smooth_m = alone ? shared_by_most(pairs_m, kNoise * sigma_m) : weight / sum;
      if (smooth_m > 0) p.distance_m.row(y)[x] = smooth_m;
    }
  }
}

namespace {

constexpr int kSlope_px = 6;  ///< over which a surface's slope is taken

/// Inverse distance one pixel before `near_m`, after `far_m` kSlope_px behind it, on a surface that
/// goes on. On a plane it is the cosine of the angle to the normal over the plane's distance, which
/// bends by -w step^2 a pixel.
float continued_w(float near_m, float far_m, double step_rad) {
  constexpr float kMostChange = 0.25F;
  const float w = 1 / near_m;
  if (far_m <= 0) return w;
  const float bend = w * static_cast<float>(step_rad * step_rad) * 0.5F * (kSlope_px + 1);
  const float change = (w - 1 / far_m) / kSlope_px;
  return std::abs(change * kSlope_px) < kMostChange * w ? w + change - bend : w;
}

}  // namespace

bool fill_border(Panorama& p, const Panorama& before) {
  const Size size = p.size();
  const double pixel_rad = std::numbers::pi / size.height;
  bool filled = false;
  for (int y = 0; y < size.height; ++y) {
    const double across = std::sin(std::numbers::pi * (y + 0.5) / size.height);
    for (int x = 0; x < size.width; ++x) {
      if (before.field.row(y)[x] == 0 || before.distance_m.row(y)[x] > 0) continue;
      float sum_w = 0, sigma_m = 0;
      int count = 0;
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const auto row_at = [&, dy = dy](int steps) {
          return std::clamp(y + steps * dy, 0, size.height - 1);
        };
        const auto column_at = [&, dx = dx](int steps) {
          return (x + steps * dx + size.width) % size.width;
        };
        const float near_m = before.distance_m.row(row_at(1))[column_at(1)];
        if (near_m <= 0) continue;
        const int far = 1 + kSlope_px;
        sum_w += continued_w(near_m, before.distance_m.row(row_at(far))[column_at(far)],
                             dx != 0 ? pixel_rad * across : pixel_rad);
        ++count;
        sigma_m = std::max(sigma_m, before.sigma_m.row(row_at(1))[column_at(1)]);
      }
      if (count == 0) continue;
      p.distance_m.row(y)[x] = static_cast<float>(count) / sum_w;
      p.sigma_m.row(y)[x] = 1.5F * sigma_m;
      filled = true;
    }
  }
  return filled;
}

}  // namespace mixrig::model
