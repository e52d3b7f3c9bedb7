// SPDX-License-Identifier: Apache-2.0
#include "host/model/panorama_color.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/base/srgb.h"
#include "host/model/around.h"

namespace mixrig::model {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kPaintGrain = 8;
constexpr float kSameSurface_m = 0.02F;  ///< beyond noise
constexpr float kUnmeasured = 1e-3F;     ///< weight of a view that measured nothing there

/// A view with what its colour needs.
struct Eye {
  const ScanView* view = nullptr;
  geometry::Pose tof_from_base, target_from_base;
  Vector3d place_m, axis;  ///< of the target camera
};

/// Whether the depth camera sees the point (1), measured nothing or only what is behind it
/// (kUnmeasured), or something before it (0).
float visible(const Eye& eye, const Vector3d& point_m, const geometry::CameraModel& tof) {
  const Vector3d p = eye.tof_from_base * point_m;
  if (p.z() <= 0) return kUnmeasured;
  const auto px = tof.project(p);
  if (!px) return kUnmeasured;
  const Image<float>& measured_m = eye.view->distance_m;
  const int x = static_cast<int>(std::floor(px->x())), y = static_cast<int>(std::floor(px->y()));
  if (x < 0 || y < 0 || x + 1 >= measured_m.width() || y + 1 >= measured_m.height())
    return kUnmeasured;
  const auto away_m = static_cast<float>(p.norm());
  bool before = false;
  for (int i = 0; i < 4; ++i) {
    const float there_m = measured_m.row(y + i / 2)[x + i % 2];
    const float allowed_m = kSameSurface_m + 4 * eye.view->sigma_m.row(y + i / 2)[x + i % 2];
    if (there_m <= 0) continue;
    if (std::abs(there_m - away_m) <= allowed_m) return 1;
    before = before || there_m < away_m;
  }
  return before ? 0 : kUnmeasured;
}

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

/// Adds a view's colour at a point.
void add_color(const Eye& eye, const Vector3d& point_m, const geometry::CameraModel& tof,
               const geometry::CameraModel& target, Eigen::Vector4f& sum) {
  const Vector3d p = eye.target_from_base * point_m;
  if (p.z() <= 0 || eye.view->plate.empty()) return;
  const auto px = target.project(p);
  const Size size = target.size_px();
  if (!px) return;
  const double border =
      std::min({px->x(), px->y(), size.width - 1 - px->x(), size.height - 1 - px->y()});
  if (border < 0) return;
  const float weight = static_cast<float>(1 + border) * visible(eye, point_m, tof);
  sum.head<3>() += weight * color_at(eye.view->plate, *px);
  sum[3] += weight;
}

/// Cosine of the largest angle between the axis and a ray of the camera.
double widest_cosine(const geometry::CameraModel& camera) {
  const Size size = camera.size_px();
  double least = 1;
  for (const double x : {0.0, size.width - 1.0})
    for (const double y : {0.0, size.height - 1.0})
      if (const auto ray = camera.unproject({x, y}))
        least = std::min(least, 1 / std::hypot(1, ray->norm()));
  return least;
}

class Painter {
 public:
  Painter(std::span<const ScanView> views, const geometry::CameraModel& tof,
          const geometry::CameraModel& target, int factor, const Panorama& panorama)
      : tof_(tof),
        target_(target),
        factor_(factor),
        panorama_(panorama),
        size_{factor * panorama.size().width, factor * panorama.size().height},
        least_cosine_(widest_cosine(target)),
        directions_(size_) {
    for (const ScanView& view : views)
      eyes_.push_back({&view, geometry::inverse(view.base_from_tof),
                       geometry::inverse(view.base_from_target),
                       view.base_from_target.translation_m,
                       view.base_from_target.rotation * Vector3d::UnitZ()});
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
    for (const Eye& eye : eyes_) {
      const Vector3d from_eye = point_m - eye.place_m;
      if (from_eye.dot(eye.axis) < least_cosine_ * from_eye.norm()) continue;
      add_color(eye, point_m, tof_, target_, sum);
    }
    if (sum[3] <= 0) return {};
    const auto byte = [&](int i) {
      return srgb_[static_cast<std::size_t>(65535 * sum[i] / sum[3] + 0.5F)];
    };
    return {byte(0), byte(1), byte(2)};
  }

  const geometry::CameraModel& tof_;
  const geometry::CameraModel& target_;
  int factor_;
  const Panorama& panorama_;
  Size size_;  ///< of the colour
  double least_cosine_;
  std::vector<Eye> eyes_;
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
