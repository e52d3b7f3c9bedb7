// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "hal/base/order_statistics.h"
#include "host/room/scan/panorama/panorama.h"

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

namespace {

/// Variance of a distance: (shot * amplitude + floor) / amplitude^2. Phase from taps whose charges
/// have shot noise and a noise of their own (Lange and Seitz 2001).
struct LightNoise {
  double shot = 0, floor = 0;
  double variance(float weight, float count) const {
    return (shot * std::sqrt(weight / count) + floor) / weight;
  }
};

struct Scatter {
  float amplitude = 0, times_amplitude = 0;  ///< the second is that of one frame
};

/// Differences of each pixel from the mean of those beside it.
std::vector<Scatter> scatter_of(const Image<float>& mean_m, const Image<float>& weight,
                                const Image<float>& count) {
  constexpr float kOfOne = 1.2247F;  // |a - (b + c) / 2| of equal sigmas
  std::vector<Scatter> all;
  for (int y = 0; y < mean_m.height(); ++y)
    for (int x = 1; x + 1 < mean_m.width(); ++x) {
      const float* at = mean_m.row(y) + x;
      if (at[-1] <= 0 || at[0] <= 0 || at[1] <= 0) continue;
      const float w = weight.row(y)[x];
      all.push_back({std::sqrt(w / count.row(y)[x]),
                     std::abs(at[0] - 0.5F * (at[-1] + at[1])) * std::sqrt(w) / kOfOne});
    }
  return all;
}

/// Estimates the noise from the darker and the brighter half of the pixels; zero for fewer than 100
/// pixels, or where the amplitudes hardly differ: the camera has none.
LightNoise noise_of(std::vector<Scatter> all) {
  constexpr double kMedianOfNoise = 0.6745;
  if (all.size() < 100) return {};
  const auto half = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  const auto darker = [](const Scatter& a, const Scatter& b) { return a.amplitude < b.amplitude; };
  std::nth_element(all.begin(), half, all.end(), darker);
  const auto medians = [&](auto begin, auto end) {
    std::vector<float> amplitude, scatter;
    for (auto at = begin; at != end; ++at)
      amplitude.push_back(at->amplitude), scatter.push_back(at->times_amplitude);
    const double sigma = upper_median_in_place(std::span(scatter)) / kMedianOfNoise;
    return std::pair<double, double>(upper_median_in_place(std::span(amplitude)), sigma * sigma);
  };
  const auto [dark, of_dark] = medians(all.begin(), half);
  const auto [bright, of_bright] = medians(half, all.end());
  if (bright < 1.01 * dark) return {};
  const double shot = std::clamp((of_bright - of_dark) / (bright - dark), 0.0, of_dark / dark);
  return {shot, of_dark - shot * dark};
}

}  // namespace

void ViewAverage::finish(Image<float>& distance_m, Image<float>& sigma_m) const {
  distance_m.reset(ray_.size()), sigma_m.reset(ray_.size());
  Image<float> weight(ray_.size()), count(ray_.size());
  for (int y = 0; y < ray_.height(); ++y)
    for (int x = 0; x < ray_.width(); ++x) {
      const Surface seen = most_seen(surfaces_.row(y)[x]);
      if (seen.count == 0) continue;
      distance_m.row(y)[x] = seen.mean_m();
      weight.row(y)[x] = seen.weight, count.row(y)[x] = static_cast<float>(seen.count);
    }
  const LightNoise noise = noise_of(scatter_of(distance_m, weight, count));
  for (int y = 0; y < ray_.height(); ++y)
    for (int x = 0; x < ray_.width(); ++x) {
      const float mean_m = distance_m.row(y)[x];
      if (mean_m <= 0) continue;
      const auto one_m = static_cast<float>(
          noise_.sigma_m(static_cast<double>(mean_m) * z_of_distance_.row(y)[x]));
      const auto by_light_m =
          static_cast<float>(std::sqrt(noise.variance(weight.row(y)[x], count.row(y)[x])));
      sigma_m.row(y)[x] = std::max(one_m / std::sqrt(count.row(y)[x]), by_light_m);
    }
}

}  // namespace mixrig::model
