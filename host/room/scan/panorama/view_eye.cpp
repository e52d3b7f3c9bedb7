// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/view_eye.h"

#include <algorithm>
#include <cmath>

namespace mixrig::model {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr float kSameSurface_m = 0.02F;  ///< beyond noise

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

}  // namespace

ViewEye::ViewEye(const ScanView& view, const geometry::CameraModel& tof,
                 const geometry::CameraModel& target)
    : view_(&view),
      tof_(&tof),
      target_(&target),
      tof_from_base_(geometry::inverse(view.base_from_tof)),
      target_from_base_(geometry::inverse(view.base_from_target)),
      axis_(view.base_from_target.rotation * Vector3d::UnitZ()),
      least_cosine_(widest_cosine(target)) {}

std::optional<Vector2d> ViewEye::pixel(const Vector3d& point_m) const {
  const Vector3d from_eye = point_m - view_->base_from_target.translation_m;
  if (from_eye.dot(axis_) < least_cosine_ * from_eye.norm() || view_->plate.empty()) return {};
  const Vector3d p = target_from_base_ * point_m;
  if (p.z() <= 0) return {};
  const auto px = target_->project(p);
  const Size size = target_->size_px();
  if (!px || px->x() < 0 || px->y() < 0 || px->x() > size.width - 1 || px->y() > size.height - 1)
    return {};
  return *px;
}

float ViewEye::visible(const Vector3d& point_m) const {
  const Vector3d p = tof_from_base_ * point_m;
  if (p.z() <= 0) return kUnmeasured;
  const auto px = tof_->project(p);
  if (!px) return kUnmeasured;
  const Image<float>& measured_m = view_->distance_m;
  const int x = static_cast<int>(std::floor(px->x())), y = static_cast<int>(std::floor(px->y()));
  if (x < 0 || y < 0 || x + 1 >= measured_m.width() || y + 1 >= measured_m.height())
    return kUnmeasured;
  const auto away_m = static_cast<float>(p.norm());
  bool before = false;
  for (int i = 0; i < 4; ++i) {
    const float there_m = measured_m.row(y + i / 2)[x + i % 2];
    const float allowed_m = kSameSurface_m + 4 * view_->sigma_m.row(y + i / 2)[x + i % 2];
    if (there_m <= 0) continue;
    if (std::abs(there_m - away_m) <= allowed_m) return 1;
    before = before || there_m < away_m;
  }
  return before ? 0 : kUnmeasured;
}

}  // namespace mixrig::model
