// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/window_filters.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mixrig::depth {
namespace {

/// Returns the Gaussian weight of a difference; with a sigma of 0 only equal values count.
double weight(double difference, double sigma) {
  if (sigma <= 0) return difference == 0 ? 1 : 0;
  const double scaled = difference / sigma;
  return std::exp(-0.5 * scaled * scaled);
}

/// Returns the spatial weights, row by row, of every pixel of the window.
std::vector<double> spatial_weights(Window window) {
  std::vector<double> weights;
  for (int y = -window.radius_px; y <= window.radius_px; ++y)
    for (int x = -window.radius_px; x <= window.radius_px; ++x)
      weights.push_back(weight(std::hypot(x, y), window.sigma_px()));
  return weights;
}
double at(const std::vector<double>& weights, Window window, int dx, int dy) {
  const int row = dy + window.radius_px, column = dx + window.radius_px;
  return weights[static_cast<std::size_t>(row * (2 * window.radius_px + 1) + column)];
}

/// Calls use(x, y, depth) for every known depth of the window around (x, y).
template <typename Use>
void for_known(ImageView<const float> depth_m, Window window, int x, int y, const Use& use) {
  const int top = std::max(0, y - window.radius_px),
            bottom = std::min(depth_m.size.height - 1, y + window.radius_px);
  const int left = std::max(0, x - window.radius_px),
            right = std::min(depth_m.size.width - 1, x + window.radius_px);
  for (int v = top; v <= bottom; ++v)
    for (int u = left; u <= right; ++u)
      if (const float near = depth_m.row(v)[u]; near > 0) use(u, v, near);
}

/// Computes the weighted mean of the window of each known pixel, or of each pixel with `fill`.
/// `weigh(x, y, u, v, depth)` is the weight of (u, v) for (x, y).
template <typename Weigh>
void weighted(ImageView<const float> depth_m, Window window, bool fill, const Weigh& weigh,
              ImageView<float> out) {
  for (int y = 0; y < depth_m.size.height; ++y)
    for (int x = 0; x < depth_m.size.width; ++x) {
      double sum = 0, weights = 0;
      if (fill || depth_m.row(y)[x] > 0)
        for_known(depth_m, window, x, y, [&](int u, int v, float near) {
          const double w = weigh(x, y, u, v, near);
          sum += w * static_cast<double>(near);
          weights += w;
        });
      out.row(y)[x] = weights > 0 ? static_cast<float>(sum / weights) : 0.0F;
    }
}

}  // namespace

void gaussian(ImageView<const float> depth_m, Window window, ImageView<float> out) {
  const std::vector<double> spatial = spatial_weights(window);
  weighted(
      depth_m, window, false,
      [&](int x, int y, int u, int v, float) { return at(spatial, window, u - x, v - y); }, out);
}

void median(ImageView<const float> depth_m, Window window, ImageView<float> out) {
  std::vector<float> known;
  for (int y = 0; y < depth_m.size.height; ++y)
    for (int x = 0; x < depth_m.size.width; ++x) {
      known.clear();
      if (depth_m.row(y)[x] > 0)
        for_known(depth_m, window, x, y, [&](int, int, float near) { known.push_back(near); });
      const auto middle = known.begin() + (static_cast<std::ptrdiff_t>(known.size()) - 1) / 2;
      if (!known.empty()) std::nth_element(known.begin(), middle, known.end());
      out.row(y)[x] = known.empty() ? 0.0F : *middle;
    }
}

void bilateral(ImageView<const float> depth_m, Window window, double sigma_m,
               ImageView<float> out) {
  const std::vector<double> spatial = spatial_weights(window);
  weighted(
      depth_m, window, false,
      [&](int x, int y, int u, int v, float near) {
        return weight(near - depth_m.row(y)[x], sigma_m) * at(spatial, window, u - x, v - y);
      },
      out);
}

void joint_bilateral(ImageView<const float> depth_m, ImageView<const float> luma, Window window,
                     double sigma_m, double sigma_luma, ImageView<float> out) {
  weighted(
      depth_m, window, true,
      [&](int x, int y, int u, int v, float near) {
        const float own = depth_m.row(y)[x];
        const double f = own > 0 ? weight(near - own, sigma_m) : 1;
        return f * weight(luma.row(v)[u] - luma.row(y)[x], sigma_luma);
      },
      out);
}

}  // namespace mixrig::depth
