// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "host/model/panorama.h"

namespace mixrig::model {
namespace {

// Wider than the noise of dark surfaces, narrower than people are deep.
constexpr float kTwoSurfaces_m = 0.1F, kTwoSurfacesSigmas = 4;

}  // namespace

ViewAverage::ViewAverage(const geometry::CameraModel& tof, const geometry::DepthNoise& noise,
                         bool depth_is_distance)
    : noise_(noise), ray_(tof.size_px()), z_of_distance_(tof.size_px()) {
  for (int y = 0; y < ray_.height(); ++y)
    for (int x = 0; x < ray_.width(); ++x) {
      const auto ideal = tof.unproject(Eigen::Vector2d(x, y));
      if (!ideal) continue;
      const auto length = static_cast<float>(std::sqrt(1 + ideal->squaredNorm()));
      ray_.row(y)[x] = depth_is_distance ? 1.0F : length;
      z_of_distance_.row(y)[x] = 1 / length;
    }
  clear();
}

void ViewAverage::clear() { surfaces_.reset(ray_.size()); }

void ViewAverage::add(float distance_m, float weight, float gap_m, Surfaces& to) const {
  for (Surface& surface : to) {
    if (surface.count > 0 && std::abs(distance_m - surface.mean_m()) > gap_m) continue;
    surface.sum_m += weight * distance_m, surface.weight += weight;
    ++surface.count;
    return;
  }
}

void ViewAverage::add(ImageView<const float> depth_m, ImageView<const float> amplitude) {
  for (int y = 0; y < ray_.height(); ++y)
    for (int x = 0; x < ray_.width(); ++x) {
      const float depth = depth_m.row(y)[x];
      if (!(depth > 0) || !std::isfinite(depth)) continue;
      const float a = amplitude.empty() ? 1.0F : amplitude.row(y)[x];
      const float weight = a * a;
      if (!(a > 0) || !std::isfinite(weight) || weight <= 0) continue;
      const float distance_m = ray_.row(y)[x] * depth;
      const auto sigma_m = static_cast<float>(
          noise_.sigma_m(static_cast<double>(distance_m) * z_of_distance_.row(y)[x]));
      add(distance_m, weight, kTwoSurfaces_m + kTwoSurfacesSigmas * sigma_m, surfaces_.row(y)[x]);
    }
}

ViewAverage::Surface ViewAverage::most_seen(const Surfaces& all) {
  const Surface& best =
      *std::max_element(all.begin(), all.end(), [](const Surface& a, const Surface& b) {
        return a.count != b.count ? a.count < b.count : a.count > 0 && a.mean_m() < b.mean_m();
      });
  if (best.count > 1) return best;
  Surface mean;
  for (const Surface& surface : all)
    mean.sum_m += surface.sum_m, mean.weight += surface.weight, mean.count += surface.count;
  return mean;
}

void ViewAverage::finish(Image<float>& distance_m, Image<float>& sigma_m) const {
  distance_m.reset(ray_.size()), sigma_m.reset(ray_.size());
  for (int y = 0; y < ray_.height(); ++y)
    for (int x = 0; x < ray_.width(); ++x) {
      const Surface seen = most_seen(surfaces_.row(y)[x]);
      if (seen.count == 0) continue;
      const float mean_m = seen.mean_m();
      const double one_m = noise_.sigma_m(static_cast<double>(mean_m) * z_of_distance_.row(y)[x]);
      distance_m.row(y)[x] = mean_m;
      sigma_m.row(y)[x] = static_cast<float>(one_m / std::sqrt(seen.count));
    }
}

}  // namespace mixrig::model
