// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/slip.h"

#include <cmath>

namespace mixrig::measure {
namespace {

constexpr double kNearestSlip_m = 0.01;
constexpr double kChi2Of95Pct = 5.991;  ///< of two degrees of freedom

}  // namespace

std::optional<PixelPoint> pixel_of(const Point3& world_m, const CameraPlace& world_from_camera,
                                   const IdealView& view) {
  const auto& [x, y, z, w] = world_from_camera.rotation_xyzw;
  const Point3& eye = world_from_camera.translation_m;
  const double d[3] = {world_m[0] - eye[0], world_m[1] - eye[1], world_m[2] - eye[2]};
  // Columns of the rotation matrix are the camera's axes in the world.
  const double right =
      (1 - 2 * (y * y + z * z)) * d[0] + 2 * (x * y + w * z) * d[1] + 2 * (x * z - w * y) * d[2];
  const double down =
      2 * (x * y - w * z) * d[0] + (1 - 2 * (x * x + z * z)) * d[1] + 2 * (y * z + w * x) * d[2];
  const double forward =
      2 * (x * z + w * y) * d[0] + 2 * (y * z - w * x) * d[1] + (1 - 2 * (x * x + y * y)) * d[2];
  if (!(forward >= kNearestSlip_m)) return std::nullopt;
  return PixelPoint{view.fx_px * right / forward + view.cx_px,
                    view.fy_px * down / forward + view.cy_px};
}

bool within_95_pct(const PixelPoint& error_px, const PixelCovariance& s) {
  const double determinant = s.xx * s.yy - s.xy * s.xy;
  if (!(s.xx > 0) || !(determinant > 0)) return false;
  const auto& [x, y] = error_px;
  return s.yy * x * x - 2 * s.xy * x * y + s.xx * y * y <= kChi2Of95Pct * determinant;
}

void SlipSums::add(double distance_px) {
  if (distances_.add(distance_px)) square_px2_ += distance_px * distance_px;
}

double SlipSums::rms_px() const {
  return count() == 0 ? 0.0 : std::sqrt(square_px2_ / static_cast<double>(count()));
}

}  // namespace mixrig::measure
