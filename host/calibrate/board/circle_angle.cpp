// SPDX-License-Identifier: Apache-2.0
// The angle of an image circle's rim under a lens.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/calibrate/board/image_circle.h"

namespace mixrig::calibration {

Error folds_in_circle(const geometry::AnyCamera& lens, const ImageCircle& circle) {
  const double fold_deg = std::get<geometry::FisheyeModel>(lens).fold_rad() * 180 / M_PI;
  return {ErrorCode::kData,
          fmt::format("the lens folds inside its image circle of radius {:.1f} px, {:.1f} degrees "
                      "from its axis: show the board nearer to the rim, or ask for fewer terms by "
                      "--lens",
                      circle.radius_px, fold_deg)};
}

Result<std::optional<double>> rim_angle_rad(const geometry::AnyCamera& lens,
                                            const ImageCircle& circle) {
  const Size size = geometry::size_px(lens);
  constexpr int kDirections = 720;
  std::optional<double> least;
  for (int i = 0; i < kDirections; ++i) {
    const double phi = i * 2 * M_PI / kDirections;
    const Eigen::Vector2d px =
        circle.center_px + circle.radius_px * Eigen::Vector2d(std::cos(phi), std::sin(phi));
    if (px.x() < 0 || px.y() < 0 || px.x() > size.width - 1 || px.y() > size.height - 1) continue;
    const auto ray = geometry::unproject(lens, px);
    if (!ray) return folds_in_circle(lens, circle);
    least = std::min(least.value_or(M_PI), std::atan2(ray->head<2>().norm(), ray->z()));
  }
  return least;
}

}  // namespace mixrig::calibration
