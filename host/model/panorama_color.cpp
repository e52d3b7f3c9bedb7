// SPDX-License-Identifier: Apache-2.0
#include "host/model/panorama_color.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/base/srgb.h"
#include "host/model/around.h"
#include "host/model/view_eye.h"

namespace mixrig::model {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kPaintGrain = 8;

/// Bilinear, in linear light.
Eigen::Vector3f color_at(const Image<Rgb8>& plate, const Vector2d& px) {
  const auto& linear = linear_of_srgb_bytes();
  const int x = std::clamp(static_cast<int>(px.x()), 0, plate.width() - 2);
  const int y = std::clamp(static_cast<int>(px.y()), 0, plate.height() - 2);
  const auto fx = static_cast<float>(px.x() - x), fy = static_cast<float>(px.y() - y);
  const auto of = [&](const Rgb8& c) {
    return Eigen::Vector3f(linear[c.r], linear[c.g], linear[c.b]);
  };
  const Rgb8 *top = plate.row(y) + x, *bottom = plate.row(y + 1) + x;
  return (1 - fy) * ((1 - fx) * of(top[0]) + fx * of(top[1])) +
         fy * ((1 - fx) * of(bottom[0]) + fx * of(bottom[1]));
}

class Painter {
 public:
  Painter(std::span<const ScanView> views, const geometry::CameraModel& tof,
          const geometry::CameraModel& target, int factor, const Panorama& panorama)
      : target_(target),
        factor_(factor),
        panorama_(panorama),
        size_{factor * panorama.size().width, factor * panorama.size().height},
        directions_(size_) {
    for (const ScanView& view : views) eyes_.emplace_back(view, tof, target);
  }

  void row(int y, Rgb8* to) const {
    for (int x = 0; x < size_.width; ++x) {
      const float distance_m =
          distance_between(panorama_, (x + 0.5) / factor_ - 0.5, (y + 0.5) / factor_ - 0.5);
      if (distance_m <= 0) continue;
      to[x] = color_of_point(distance_m * directions_(x, y));
    }
  }

 private:
  Rgb8 color_of_point(const Vector3d& point_m) const {
    Eigen::Vector4f sum = Eigen::Vector4f::Zero();
    for (std::size_t i = 0; i < eyes_.size(); ++i)
      if (const auto px = eyes_[i].pixel(point_m)) add_color(i, point_m, *px, sum);
    if (sum[3] <= 0) return {};
    const auto byte = [&](int i) {
      return srgb_[static_cast<std::size_t>(65535 * std::min(sum[i] / sum[3], 1.0F) + 0.5F)];
    };
    return {byte(0), byte(1), byte(2)};
  }

  void add_color(std::size_t view, const Vector3d& point_m, const Vector2d& px,
                 Eigen::Vector4f& sum) const {
    const ViewEye& eye = eyes_[view];
    const double border = std::min({px.x(), px.y(), target_.size_px().width - 1 - px.x(),
                                    target_.size_px().height - 1 - px.y()});
    const float weight = static_cast<float>(1 + border) * eye.visible(point_m);
    if (weight <= 0) return;
    Eigen::Array3f color = color_at(eye.plate(), px);
    if (const ViewGains& g = panorama_.gains; !g.gains.empty())
      color *= g.gains[view] * static_cast<float>(g.vignetting.factor(
                                   geometry::Vignetting::radius2(target_.pinhole, px)));
    sum.head<3>() += weight * color.matrix();
    sum[3] += weight;
  }

  const geometry::CameraModel& target_;
  int factor_;
  const Panorama& panorama_;
  Size size_;  ///< of the colour
  std::vector<ViewEye> eyes_;
  Directions directions_;
  const std::vector<std::uint8_t>& srgb_ = srgb_bytes_of_linear16();
};

}  // namespace

float distance_between(const Panorama& p, double x, double y) {
  const Around around(p.size(), {x, y});
  const auto d = around.of(p.distance_m);
  const auto [low, high] = std::minmax({d[0], d[1], d[2], d[3]});
  if (low <= 0 || is_depth_step(low, high)) return d[around.nearest()];
  return 1 / around.mix(1 / d[0], 1 / d[1], 1 / d[2], 1 / d[3]);
}

void paint(std::span<const ScanView> views, const geometry::CameraModel& tof,
           const geometry::CameraModel& target, int factor, Panorama& panorama, Crew& crew) {
  const Painter painter(views, tof, target, factor, panorama);
  const Size size{factor * panorama.size().width, factor * panorama.size().height};
  panorama.color.reset(size);
  crew.rows(size.height, kPaintGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) painter.row(y, panorama.color.row(y));
  });
}

}  // namespace mixrig::model
