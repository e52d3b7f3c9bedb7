// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/depth_correction.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace mixrig::depth {
namespace {

constexpr int kSteps = 2048;

}  // namespace

DepthCorrection::DepthCorrection(const calibration_file::DepthError& error,
                                 const geometry::CameraModel& tof, bool depth_is_distance)
    : amplitude_m_(static_cast<float>(error.amplitude_m)),
      place_m_(tof.size_px()),
      ray_(tof.size_px()) {
  const double first_m = error.knots_m.front(), span_m = error.knots_m.back() - first_m;
  first_m_ = static_cast<float>(first_m);
  steps_per_m_ = static_cast<float>((kSteps - 1) / span_m);
  calibration_file::DepthError along = error;
  along.place_m = {};
  const auto spline_m = [&](double distance_m) {
    return along.at(distance_m, 0, {0, 0}, tof.size_px());
  };
  for (int i = 0; i < kSteps; ++i)
    error_m_.push_back(static_cast<float>(spline_m(first_m + span_m * i / (kSteps - 1))));
  calibration_file::DepthError place = error;
  place.error_m.assign(error.error_m.size(), 0);
  for (int y = 0; y < ray_.height(); ++y)
    for (int x = 0; x < ray_.width(); ++x) {
      const Eigen::Vector2d px(x, y);
      const auto ideal = tof.unproject(px);
      place_m_.at(x, y) = static_cast<float>(place.at(first_m, 0, px, tof.size_px()));
      ray_.at(x, y) = depth_is_distance ? 1.0F
                      : ideal           ? static_cast<float>(ideal->homogeneous().norm())
                                        : std::numeric_limits<float>::quiet_NaN();
    }
}

/// Returns the error, linear between the steps and constant beyond the ends.
float DepthCorrection::at(float distance_m) const {
  const float step = std::clamp((distance_m - first_m_) * steps_per_m_, 0.0F, kSteps - 1.0F);
  const auto i = static_cast<std::size_t>(std::min(step, kSteps - 2.0F));
  return error_m_[i] + (step - static_cast<float>(i)) * (error_m_[i + 1] - error_m_[i]);
}

void DepthCorrection::apply(ImageView<float> depth_m, ImageView<const float> amplitude) const {
  assert(depth_m.size == ray_.size() && (amplitude.empty() || amplitude.size == ray_.size()));
  const bool by_amplitude = wants_amplitude() && !amplitude.empty();
  for (int y = 0; y < depth_m.size.height; ++y)
    for (int x = 0; x < depth_m.size.width; ++x) {
      float& depth = depth_m.row(y)[x];
      const float ray = ray_.row(y)[x], distance_m = depth * ray;
      if (!(distance_m > 0.0F) || !std::isfinite(distance_m)) continue;
      float corrected_m = distance_m - at(distance_m) - place_m_.row(y)[x];
      if (by_amplitude && amplitude.row(y)[x] > 0.0F)
        corrected_m -= amplitude_m_ / amplitude.row(y)[x];
      depth = std::max(corrected_m, 0.0F) / ray;
    }
}

}  // namespace mixrig::depth
