// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/panorama_color.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/base/half.h"
#include "hal/base/srgb.h"
#include "host/room/scan/panorama/around.h"
#include "host/room/scan/panorama/view_eye.h"

namespace mixrig::model {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kPaintGrain = 8;
constexpr float kSaturatedPlate = 0.955F;  ///< linear; from byte 250 on

Eigen::Array3f linear_of(const Rgb8& c) {
  const auto& linear = linear_of_srgb_bytes();
  return {linear[c.r], linear[c.g], linear[c.b]};
}
Eigen::Array3f linear_of(const RgbHalf& c) {
  return {float_of_half(c.r), float_of_half(c.g), float_of_half(c.b)};
}

/// Bilinear, in linear light, and the largest channel of the four pixels.
template <typename Pixel>
Eigen::Array3f color_at(const Image<Pixel>& plate, const Vector2d& px, float& largest) {
  const int x = std::clamp(static_cast<int>(px.x()), 0, plate.width() - 2);
  const int y = std::clamp(static_cast<int>(px.y()), 0, plate.height() - 2);
  const auto fx = static_cast<float>(px.x() - x), fy = static_cast<float>(px.y() - y);
  const Pixel *top = plate.row(y) + x, *bottom = plate.row(y + 1) + x;
  const Eigen::Array3f a = linear_of(top[0]), b = linear_of(top[1]), c = linear_of(bottom[0]),
                       d = linear_of(bottom[1]);
  largest = a.max(b).max(c.max(d)).maxCoeff();
  return (1 - fy) * ((1 - fx) * a + fx * b) + fy * ((1 - fx) * c + fx * d);
}

/// Weighted sums of what views see of a point.
struct SeenColor {
  Eigen::Vector4f plate = Eigen::Vector4f::Zero();
  Eigen::Vector4f light = Eigen::Vector4f::Zero(), limit = light;  ///< limit: where saturated
};

RgbHalf half_of(const Eigen::Vector4f& sum) {
  return {half_of_float(sum[0] / sum[3]), half_of_float(sum[1] / sum[3]),
          half_of_float(sum[2] / sum[3])};
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
    for (const ScanView& view : views) {
      eyes_.emplace_back(view, tof, target);
      has_light_ = has_light_ || !view.light.empty();
    }
  }

  bool has_light() const { return has_light_; }

  /// Light and its flag only where some view has light.
  void row(int y, Rgb8* to, RgbHalf* light, std::uint8_t* saturated) const {
    for (int x = 0; x < size_.width; ++x) {
      const float distance_m =
          distance_between(panorama_, (x + 0.5) / factor_ - 0.5, (y + 0.5) / factor_ - 0.5);
      if (distance_m <= 0) continue;
      const SeenColor seen = color_of_point(distance_m * directions_(x, y));
      to[x] = bytes_of(seen.plate);
      if (!has_light_ || seen.plate[3] <= 0) continue;
      saturated[x] = seen.light[3] > 0 ? 0 : 1;
      light[x] = half_of(seen.light[3] > 0 ? seen.light : seen.limit);
    }
  }

 private:
  SeenColor color_of_point(const Vector3d& point_m) const {
    SeenColor seen;
    for (std::size_t i = 0; i < eyes_.size(); ++i)
      if (const auto px = eyes_[i].pixel(point_m)) add_color(i, point_m, *px, seen);
    return seen;
  }

  Rgb8 bytes_of(const Eigen::Vector4f& sum) const {
    if (sum[3] <= 0) return {};
    const auto byte = [&](int i) {
      return srgb_[static_cast<std::size_t>(65535 * std::min(sum[i] / sum[3], 1.0F) + 0.5F)];
    };
    return {byte(0), byte(1), byte(2)};
  }

  void add_color(std::size_t view, const Vector3d& point_m, const Vector2d& px,
                 SeenColor& seen) const {
    const ViewEye& eye = eyes_[view];
    const double border = std::min({px.x(), px.y(), target_.size_px().width - 1 - px.x(),
                                    target_.size_px().height - 1 - px.y()});
    const float weight = static_cast<float>(1 + border) * eye.visible(point_m);
    if (weight <= 0) return;
    Eigen::Array3f gain = Eigen::Array3f::Ones();
    if (const ViewGains& g = panorama_.gains; !g.gains.empty())
      gain = g.gains[view] * static_cast<float>(g.vignetting.factor(
                                 geometry::Vignetting::radius2(target_.pinhole, px)));
    const auto add = [&](const Eigen::Array3f& color, Eigen::Vector4f& sum) {
      sum.head<3>() += weight * (gain * color).matrix();
      sum[3] += weight;
    };
    float largest = 0, limit = kSaturatedPlate;
    Eigen::Array3f color = color_at(eye.plate(), px, largest);
    add(color, seen.plate);
    if (!has_light_) return;
    if (const ScanView& of = eye.view(); !of.light.empty())
      color = color_at(of.light, px, largest), limit = of.light_limit;
    add(color, largest >= limit ? seen.limit : seen.light);
  }

  const geometry::CameraModel& target_;
  int factor_;
  const Panorama& panorama_;
  Size size_;  ///< of the colour
  bool has_light_ = false;
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
  if (painter.has_light()) panorama.light.reset(size), panorama.light_saturated.reset(size);
  crew.rows(size.height, kPaintGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      painter.row(y, panorama.color.row(y), painter.has_light() ? panorama.light.row(y) : nullptr,
                  painter.has_light() ? panorama.light_saturated.row(y) : nullptr);
  });
}

}  // namespace mixrig::model
