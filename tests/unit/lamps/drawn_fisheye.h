// SPDX-License-Identifier: Apache-2.0
// Fisheye pictures by formula: an equidistant lens, radius = f angle, without the pipeline.
#pragma once

#include <cmath>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hal/base/image.h"
#include "host/math/geometry/pose.h"

namespace mixrig::test {

struct DrawnFisheye {
  Size size{640, 512};
  double f_px = 157, most_rad = 1.6;

  /// Ray of a pixel in camera axes; nullopt beyond the image circle.
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& px) const {
    const Eigen::Vector2d off = px - centre();
    const double angle = off.norm() / f_px;
    if (angle > most_rad) return std::nullopt;
    if (angle < 1e-12) return Eigen::Vector3d::UnitZ();
    const Eigen::Vector2d side = off.normalized();
    return Eigen::Vector3d(std::sin(angle) * side.x(), std::sin(angle) * side.y(), std::cos(angle));
  }
  Eigen::Vector2d centre() const { return {0.5 * (size.width - 1), 0.5 * (size.height - 1)}; }

  /// `grey_of(ray)`: 0 to 255, for a ray in camera axes. Each pixel is the mean of `samples` x
  /// `samples` rays.
  template <typename GreyOf>
  Image<Rgb8> draw(const GreyOf& grey_of, int samples = 1) const {
    Image<Rgb8> picture(size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        double sum = 0;
        for (int j = 0; j < samples; ++j)
          for (int i = 0; i < samples; ++i) {
            const auto r = ray({x + (i + 0.5) / samples - 0.5, y + (j + 0.5) / samples - 0.5});
            if (r) sum += grey_of(*r);
          }
        const auto grey = static_cast<std::uint8_t>(
            std::lround(std::clamp(sum / (samples * samples), 0.0, 255.0)));
        picture.at(x, y) = {grey, grey, grey};
      }
    return picture;
  }
};

/// Pose of a camera that looks along `ahead`, with the picture's down at -z of the world.
inline geometry::Pose looking(const Eigen::Vector3d& eye, const Eigen::Vector3d& ahead) {
  Eigen::Matrix3d axes;
  const Eigen::Vector3d z = ahead.normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  axes << x, z.cross(x), z;
  return {Eigen::Quaterniond(axes), eye};
}

}  // namespace mixrig::test
