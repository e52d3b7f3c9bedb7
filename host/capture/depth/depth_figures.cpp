// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/depth_figures.h"

#include <algorithm>
#include <cmath>

#include "hal/base/order_statistics.h"

namespace mixrig::depth {
namespace {

constexpr float kStepShare = 0.1F;  ///< of the depth: what counts as a step between surfaces
constexpr float kLevelShare =
    0.015F;  ///< of the depth: slope of the surfaces beside a step, a pixel
constexpr float kBetweenShare = 0.15F;  ///< of a step: what is farther from both surfaces flies
constexpr int kAcross_px = 4;           ///< from one surface to the other
/// Temporal over spatial noise; more means that the camera moves.
constexpr double kMostTemporal = 4;

bool measured(float z_m) { return z_m > 0 && std::isfinite(z_m); }

/// Values of one cell that two pictures have, as sums.
struct CellSums {
  double squares_m2 = 0, amplitude = 0;
  int both = 0, pixels = 0;
};

CellSums sums_of(ImageView<const float> z_m, ImageView<const float> amplitude,
                 ImageView<const float> next_m, int x0, int y0, int side) {
  CellSums sums;
  for (int y = y0; y < y0 + side; ++y)
    for (int x = x0; x < x0 + side; ++x, ++sums.pixels) {
      if (!amplitude.empty()) sums.amplitude += amplitude.row(y)[x];
      if (next_m.empty() || !measured(z_m.row(y)[x]) || !measured(next_m.row(y)[x])) continue;
      const double change_m = z_m.row(y)[x] - next_m.row(y)[x];
      sums.squares_m2 += change_m * change_m, ++sums.both;
    }
  return sums;
}

}  // namespace

void DepthMeter::add_noise(const CellGrid& grid, ImageView<const float> z_m,
                           ImageView<const float> amplitude, ImageView<const float> next_m) {
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const DepthCell& cell = grid.cells[i];
    if (!(cell.inverse_per_m > 0)) continue;
    const auto next = std::upper_bound(kLimits_m.begin(), kLimits_m.end(), 1 / cell.inverse_per_m);
    if (next == kLimits_m.end()) continue;
    Samples& samples = samples_[static_cast<std::size_t>(next - kLimits_m.begin() - 1)];
    const int x = static_cast<int>(i) % grid.size.width, y = static_cast<int>(i) / grid.size.width;
    const CellSums sums =
        sums_of(z_m, amplitude, next_m, x * grid.side_px, y * grid.side_px, grid.side_px);
    samples.spatial_m.push_back(static_cast<float>(cell.sigma_m * std::sqrt(sums.pixels)));
    if (!amplitude.empty())
      samples.amplitude.push_back(static_cast<float>(sums.amplitude / sums.pixels));
    if (2 * sums.both > sums.pixels)
      samples.temporal_m.push_back(
          static_cast<float>(std::sqrt(sums.squares_m2 / (2 * sums.both))));
  }
}

/// Looks for steps between pixels kAcross_px apart along (dx, dy), with a level surface on either
/// side.
void DepthMeter::add_steps(ImageView<const float> z_m, int dx, int dy) {
  const Size size = z_m.size;
  for (int y = dy; y + (kAcross_px + 1) * dy < size.height; ++y)
    for (int x = dx; x + (kAcross_px + 1) * dx < size.width; ++x) {
      const auto z = [&](int i) { return z_m.row(y + i * dy)[x + i * dx]; };
      const float from = z(0), to = z(kAcross_px), less = std::min(from, to);
      if (!measured(from) || !measured(to) || std::abs(to - from) < kStepShare * less) continue;
      // The step lies in the middle: it is met once, not at each place that spans it.
      const float middle = z(kAcross_px / 2);
      const float left = z(1), right = z(kAcross_px - 1);
      const bool level = std::abs(z(-1) - from) < kLevelShare * from &&
                         std::abs(z(kAcross_px + 1) - to) < kLevelShare * to;
      const bool left_on = measured(left) && std::abs(left - from) < kLevelShare * from;
      if (!level || !left_on || (measured(middle) && std::abs(middle - from) < kLevelShare * from))
        continue;
      ++steps_;
      for (const float value : {left, middle, right}) {
        if (!measured(value)) ++unknown_at_steps_;
        const float place = (value - from) / (to - from);
        if (measured(value) && place > kBetweenShare && place < 1 - kBetweenShare) ++flying_;
      }
    }
}

void DepthMeter::count_unknown(ImageView<const float> z_m) {
  for (int y = 0; y < z_m.size.height; ++y)
    for (int x = 0; x < z_m.size.width; ++x) {
      if (!std::isfinite(rays_.x.row(y)[x])) continue;
      ++pixels_;
      if (!measured(z_m.row(y)[x])) ++unknown_;
    }
}

void DepthMeter::add(ImageView<const float> z_m, ImageView<const float> amplitude,
                     ImageView<const float> next_m) {
  const CellGrid grid = cells_of(z_m, rays_);
  add_noise(grid, z_m, amplitude, next_m);
  add_steps(z_m, 1, 0), add_steps(z_m, 0, 1);
  count_unknown(z_m);
  const std::vector<SeenPlane> planes = find_planes(grid);
  for (const SeenPlane& plane : planes) planes_.push_back(flatness_of(grid, plane));
  const std::vector<SeenCorner> corners = find_corners(z_m, rays_, grid, planes);
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  ++pictures_;
}

DepthFigures DepthMeter::figures() const {
  DepthFigures out;
  out.pictures = pictures_, out.planes = planes_, out.corners = corners_, out.steps = steps_;
  out.unknown_share =
      static_cast<double>(unknown_) / static_cast<double>(std::max(pixels_, std::size_t{1}));
  const auto steps = static_cast<double>(std::max(steps_, std::size_t{1}));
  out.flying_pixels = static_cast<double>(flying_) / steps;
  out.unknown_pixels = static_cast<double>(unknown_at_steps_) / steps;
  std::vector<float> spatial_m, temporal_m;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Samples& s = samples_[i];
    spatial_m.insert(spatial_m.end(), s.spatial_m.begin(), s.spatial_m.end());
    temporal_m.insert(temporal_m.end(), s.temporal_m.begin(), s.temporal_m.end());
    if (s.spatial_m.size() < kFewestNoiseCells) continue;
    out.noise.push_back({kLimits_m[i], kLimits_m[i + 1], s.spatial_m.size(),
                         upper_median(s.spatial_m), upper_median(s.temporal_m),
                         upper_median(s.amplitude)});
  }
  out.moves = upper_median(temporal_m) > kMostTemporal * upper_median(spatial_m);
  if (out.moves)
    for (NoiseRow& row : out.noise) row.temporal_m = 0;
  return out;
}

}  // namespace mixrig::depth
