// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/features/track_align.h"

#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

namespace mixrig::reconstruction {
namespace {

constexpr int kHalf_px = 7, kSide = 2 * kHalf_px + 1, kWide = kSide + 2;
constexpr double kWindowSigma_px = 4.5;
constexpr double kLeastAlike = 0.8;  ///< correlation
constexpr double kFarthest_px = 2;   ///< from where the sighting was
constexpr double kFinestSigma_px = 0.02;

using Wide = std::array<float, kWide * kWide>;

/// Window of a sighting with a border of a pixel, in steps of the reference; false outside the
/// picture.
bool sample(const TrackLook& look, Wide& window) {
  const Image<std::uint8_t>& grey = *look.grey;
  for (int v = 0; v < kWide; ++v)
    for (int u = 0; u < kWide; ++u) {
      const Eigen::Vector2d p =
          look.px + look.from_reference * Eigen::Vector2d(u - kHalf_px - 1, v - kHalf_px - 1);
      const double x0 = std::floor(p.x()), y0 = std::floor(p.y());
      if (!(x0 >= 0 && y0 >= 0 && x0 + 1 < grey.width() && y0 + 1 < grey.height())) return false;
      const int x = static_cast<int>(x0), y = static_cast<int>(y0);
      const auto fx = static_cast<float>(p.x() - x0), fy = static_cast<float>(p.y() - y0);
      const std::uint8_t *a = grey.row(y) + x, *b = grey.row(y + 1) + x;
      const float top = static_cast<float>(a[0]) + fx * static_cast<float>(a[1] - a[0]);
      const float low = static_cast<float>(b[0]) + fx * static_cast<float>(b[1] - b[0]);
      window[static_cast<std::size_t>(v * kWide + u)] = top + fy * (low - top);
    }
  return true;
}

/// Weighted mean 0 and sum of squares 1; false for a window without contrast.
bool normalise(const std::array<float, kWide * kWide>& weights, Wide& window) {
  double sum = 0, weight = 0, squares = 0;
  for (std::size_t i = 0; i < window.size(); ++i)
    sum += static_cast<double>(weights[i] * window[i]), weight += static_cast<double>(weights[i]);
  const auto mean = static_cast<float>(sum / weight);
  for (std::size_t i = 0; i < window.size(); ++i) {
    window[i] -= mean;
    squares += static_cast<double>(weights[i] * window[i] * window[i]);
  }
  if (!(squares > 1e-3 * weight)) return false;
  const auto scale = static_cast<float>(1 / std::sqrt(squares));
  for (float& value : window) value *= scale;
  return true;
}

Wide window_weights() {
  Wide weights{};
  for (int v = 1; v + 1 < kWide; ++v)
    for (int u = 1; u + 1 < kWide; ++u) {
      const double r2 = std::pow(u - kHalf_px - 1, 2) + std::pow(v - kHalf_px - 1, 2);
      weights[static_cast<std::size_t>(v * kWide + u)] =
          static_cast<float>(std::exp(-r2 / (2 * kWindowSigma_px * kWindowSigma_px)));
    }
  return weights;
}

/// Template that sightings are aligned to.
class LookTemplate {
 public:
  explicit LookTemplate(const Wide& mean) : weights_(window_weights()), mean_(mean) {
    usable_ = normalise(weights_, mean_);
    slopes_.fill(Eigen::Vector2f::Zero());
    Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
    for (int v = 1; v + 1 < kWide; ++v)
      for (int u = 1; u + 1 < kWide; ++u) {
        const auto i = static_cast<std::size_t>(v * kWide + u);
        slopes_[i] = {0.5F * (mean_[i + 1] - mean_[i - 1]),
                      0.5F * (mean_[i + kWide] - mean_[i - kWide])};
        products +=
            static_cast<double>(weights_[i]) * (slopes_[i] * slopes_[i].transpose()).cast<double>();
      }
    usable_ = usable_ && products.determinant() > 1e-9;
    if (usable_) inverse_ = products.inverse();
  }
  bool usable() const { return usable_; }

  /// Shifts the sighting; true where it came to rest and looks alike. `window`: its last look.
  bool align(TrackLook& look, Wide& window) const {
    const Eigen::Vector2d before = look.px;
    constexpr int kMostSteps = 12;
    for (int step = 0; step < kMostSteps; ++step) {
      if (!sample(look, window) || !normalise(weights_, window)) return false;
      const auto [shift, alike] = difference(window);
      if (!(shift.norm() < kSide)) return false;
      look.px -= look.from_reference * shift;
      if (!((look.px - before).norm() < kFarthest_px)) return false;
      if (shift.norm() > 0.003) continue;
      // 1 - alike is half the sum of squared differences of two windows of sum 1.
      const double noise = (1 - alike) / 40;  // 80 pixels that count, two of them as one
      look.sigma_px = std::max(kFinestSigma_px, std::sqrt(noise * inverse_.trace()));
      return alike > kLeastAlike;
    }
    return false;
  }

 private:
  std::pair<Eigen::Vector2d, double> difference(const Wide& window) const {
    Eigen::Vector2f sum = Eigen::Vector2f::Zero();
    float product = 0;
    for (std::size_t i = 0; i < window.size(); ++i) {
      sum += weights_[i] * (window[i] - mean_[i]) * slopes_[i];
      product += weights_[i] * window[i] * mean_[i];
    }
    return {inverse_ * sum.cast<double>(), static_cast<double>(product)};
  }

  Wide weights_, mean_;
  std::array<Eigen::Vector2f, kWide * kWide> slopes_;
  Eigen::Matrix2d inverse_ = Eigen::Matrix2d::Zero();
  bool usable_ = false;
};

/// Aligns all to the template; returns the sum of the windows that agree and their number.
int align_all(const LookTemplate& to, std::span<TrackLook> looks, Wide& sum) {
  int count = 0;
  sum.fill(0);
  for (TrackLook& look : looks) {
    TrackLook moved = look;
    Wide window;
    look.sigma_px = 0;
    if (!to.align(moved, window)) continue;
    look = moved;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += window[i];
    ++count;
  }
  return count;
}

}  // namespace

Image<std::uint8_t> smoothed(ImageView<const std::uint8_t> grey) {
  Image<std::uint8_t> out(grey.size);
  const cv::Mat from(grey.size.height, grey.size.width, CV_8U, const_cast<std::uint8_t*>(grey.data),
                     static_cast<std::size_t>(grey.stride));
  cv::Mat to(grey.size.height, grey.size.width, CV_8U, out.row(0),
             static_cast<std::size_t>(out.stride()));
  cv::GaussianBlur(from, to, {0, 0}, 0.8);
  return out;
}

bool align_looks(std::span<TrackLook> looks, std::size_t reference) {
  Wide mean{};
  if (!sample(looks[reference], mean)) return false;
  std::vector<TrackLook> moved(looks.begin(), looks.end());
  constexpr int kRounds = 2;
  for (int round = 0; round <= kRounds; ++round) {
    const LookTemplate to(mean);
    if (!to.usable() || align_all(to, moved, mean) < 2) return false;
  }
  std::copy(moved.begin(), moved.end(), looks.begin());
  return true;
}

}  // namespace mixrig::reconstruction
