// SPDX-License-Identifier: Apache-2.0
// The fisheye of Kannala and Brandt (2006) in OpenCV's parameters, beyond 180 degrees.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::geometry {

/// theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), theta from the
/// optical axis; pixel = f * theta_d * (x, y) / |(x, y)| + c. Valid out to the stated largest
/// angle, or to the fold (the angle where theta_d stops growing), whichever is smaller; at most pi
/// (straight backwards): points behind the image plane project too.
///
/// The image of most fisheyes is a circle inside the picture, black around it. max_angle_rad is the
/// angle at its rim: nothing beyond it projects, and no pixel beyond it has a ray.
class FisheyeModel {
 public:
  struct Parameters {
    Size size_px;
    double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
    std::array<double, 4> k{};
    /// Largest angle from the axis, in (0, pi]; none: the lens is used out to its fold.
    std::optional<double> max_angle_rad = std::nullopt;
  };
  FisheyeModel() = default;
  explicit FisheyeModel(const Parameters& parameters);

  const Parameters& parameters() const { return parameters_; }
  Size size_px() const { return parameters_.size_px; }
  /// Greatest angle from the axis that the lens maps, rad.
  double domain_rad() const { return domain_rad_; }
  /// The angle where theta_d stops growing, or pi; independent of the stated largest angle.
  double fold_rad() const { return fold_rad_; }
  /// Half axes of the ellipse (a circle where fx = fy) about c on which the domain ends, px.
  Eigen::Vector2d rim_px() const { return {parameters_.fx_px * rim_, parameters_.fy_px * rim_}; }

  /// Pixel of a point in camera axes; nullopt outside the domain and for the origin. May lie
  /// outside the picture.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p) const;
  /// Unit direction of a pixel; nullopt beyond the rim, the end of the domain.
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& px) const;
  /// d project / d point, 2x3, inside the domain and off the backward axis.
  Eigen::Matrix<double, 2, 3> jacobian(const Eigen::Vector3d& p) const;

 private:
  Parameters parameters_;
  double fold_rad_ = 0, domain_rad_ = 0, rim_ = 0;  // rim: theta_d at the end of the domain
};

/// Checks values read from a file: finite values, positive size and focal lengths. Without a
/// largest angle, the domain must reach the middle of the picture's sides; with one, the lens must
/// not fold before it, unless beyond the picture's corners, and need not fill the picture. Errors:
/// kData, naming the value.
Result<void> validate(const FisheyeModel& camera);

}  // namespace mixrig::geometry
