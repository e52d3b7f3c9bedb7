// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/intrinsics/lens_domain.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace mixrig::calibration {
namespace {

using Eigen::Vector3d;
using geometry::AnyCamera;

constexpr double kDegree = M_PI / 180;

double angle_of(const Vector3d& ray) { return std::atan2(ray.head<2>().norm(), ray.z()); }

double fold_of(const AnyCamera& camera) {
  return std::get<geometry::FisheyeModel>(camera).fold_rad();
}

}  // namespace

double largest_point_angle_rad(const Bundle& bundle) {
  double largest = 0;
  for (const BundleView& view : bundle.views) {
    const geometry::Pose pose = pose_of(view.camera_from_board);
    for (std::size_t i = 0; i < view.points_m.size(); ++i)
      if (view.used[i] != 0) largest = std::max(largest, angle_of(pose * view.points_m[i]));
  }
  return largest;
}

Result<AnyCamera> camera_in_image(const Bundle& bundle, Size size_px,
                                  const std::optional<ImageCircle>& circle) {
  AnyCamera lens = geometry::make_camera(bundle.kind, size_px, bundle.intrinsics);
  if (circle && bundle.kind == geometry::LensKind::kFisheye) {
    MIXRIG_ASSIGN(const auto angle, rim_angle_rad(lens, *circle));
    // Points are inside the circle: one far beyond its angle lies on the lens's far side.
    if (angle && largest_point_angle_rad(bundle) > *angle + kBeyondPoints_rad)
      return folds_in_circle(lens, *circle);
    lens = geometry::make_camera(bundle.kind, size_px, bundle.intrinsics, angle);
  }
  MIXRIG_TRY(geometry::validate(lens));
  return lens;
}

Result<AnyCamera> camera_near_points(const Bundle& bundle, Size size_px) {
  const double reach = largest_point_angle_rad(bundle) + kBeyondPoints_rad;
  const AnyCamera lens = geometry::make_camera(bundle.kind, size_px, bundle.intrinsics);
  if (fold_of(lens) < reach)
    return Error{ErrorCode::kData,
                 fmt::format("the lens folds {:.1f} degrees from its axis, and points lie out to "
                             "{:.1f} degrees",
                             fold_of(lens) / kDegree, (reach - kBeyondPoints_rad) / kDegree)};
  const AnyCamera bounded = geometry::make_camera(bundle.kind, size_px, bundle.intrinsics, reach);
  MIXRIG_TRY(geometry::validate(bounded));
  return bounded;
}

}  // namespace mixrig::calibration
