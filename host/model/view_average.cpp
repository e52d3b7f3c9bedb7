// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "host/model/panorama.h"

namespace mixrig::model {

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

void ViewAverage::clear() {
  sum_m_.reset(ray_.size()), weight_.reset(ray_.size()), count_.reset(ray_.size());
}

void ViewAverage::add(ImageView<const float> depth_m, ImageView<const float> amplitude) {
  for (int y = 0; y < ray_.height(); ++y)
    for (int x = 0; x < ray_.width(); ++x) {
      const float depth = depth_m.row(y)[x];
      if (!(depth > 0) || !std::isfinite(depth)) continue;
      const float a = amplitude.empty() ? 1.0F : amplitude.row(y)[x];
      const float weight = a > 0 && std::isfinite(a) ? a * a : 0.0F;
      sum_m_.row(y)[x] += weight * ray_.row(y)[x] * depth;
      weight_.row(y)[x] += weight;
      if (weight > 0 && count_.row(y)[x] < 255) ++count_.row(y)[x];
    }
}

void ViewAverage::finish(Image<float>& distance_m, Image<float>& sigma_m) const {
  distance_m.reset(ray_.size()), sigma_m.reset(ray_.size());
  for (int y = 0; y < ray_.height(); ++y)
    for (int x = 0; x < ray_.width(); ++x) {
      if (count_.row(y)[x] == 0) continue;
      const float mean_m = sum_m_.row(y)[x] / weight_.row(y)[x];
      const double one_m = noise_.sigma_m(static_cast<double>(mean_m) * z_of_distance_.row(y)[x]);
      distance_m.row(y)[x] = mean_m;
      sigma_m.row(y)[x] = static_cast<float>(one_m / std::sqrt(count_.row(y)[x]));
    }
}

}  // namespace mixrig::model
