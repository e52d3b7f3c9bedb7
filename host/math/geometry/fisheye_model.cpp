// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/fisheye_model.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/math/geometry/lens_equations.h"

namespace mixrig::geometry {
namespace {

using Coefficients = std::array<double, 4>;

/// The angle where the mapping stops growing, or pi.
double find_fold(const Coefficients& k) {
  constexpr double kStep = 1e-3;
  for (double theta = kStep; theta < M_PI; theta += kStep) {
    if (bend_slope(k.data(), theta) > 0) continue;
    double low = theta - kStep, high = theta;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (bend_slope(k.data(), middle) > 0 ? low : high) = middle;
    }
    return low;
  }
  return M_PI;
}

/// A largest angle that validate() refuses counts as none.
double smaller(double fold_rad, const std::optional<double>& max_angle_rad) {
  return max_angle_rad && *max_angle_rad > 0 ? std::min(fold_rad, *max_angle_rad) : fold_rad;
}

Error bad_lens(const std::string& what) { return {ErrorCode::kData, what}; }

/// The lens must not fold inside its image: inside the circle where that is known, else inside the
/// circles about the centre that touch the picture's sides.
Result<void> check_fold(const FisheyeModel& camera) {
  const auto& p = camera.parameters();
  const double width = p.size_px.width - 1, height = p.size_px.height - 1;
  const double left = p.cx_px / p.fx_px, right = (width - p.cx_px) / p.fx_px;
  const double top = p.cy_px / p.fy_px, bottom = (height - p.cy_px) / p.fy_px;
  const double rim = bend(p.k.data(), camera.fold_rad());
  constexpr double kDegree = M_PI / 180;
  if (!p.max_angle_rad) {
    for (const double side : {left, right, top, bottom})
      if (std::abs(side) > rim)
        return bad_lens(fmt::format(
            "the lens folds inside the picture, {:.1f} degrees from its axis: check the "
            "coefficients k1 to k4",
            camera.fold_rad() / kDegree));
    return {};
  }
  const double corner = std::hypot(std::max(std::abs(left), std::abs(right)),
                                   std::max(std::abs(top), std::abs(bottom)));
  if (camera.fold_rad() < *p.max_angle_rad && rim < corner)
    return bad_lens(fmt::format(
        "the lens folds inside its image, {:.1f} degrees from its axis, and its largest angle is "
        "{:.1f} degrees: check the coefficients k1 to k4",
        camera.fold_rad() / kDegree, *p.max_angle_rad / kDegree));
  return {};
}

}  // namespace

FisheyeModel::FisheyeModel(const Parameters& parameters)
    : parameters_(parameters),
      fold_rad_(find_fold(parameters.k)),
      domain_rad_(smaller(fold_rad_, parameters.max_angle_rad)),
      rim_(bend(parameters.k.data(), domain_rad_)) {}

std::optional<Eigen::Vector2d> FisheyeModel::project(const Eigen::Vector3d& p) const {
  const double r = std::hypot(p.x(), p.y());
  const double theta = std::atan2(r, p.z());
  if (!(theta <= domain_rad_) || (r == 0 && !(p.z() > 0))) return std::nullopt;
  // Near the axis theta_d / r tends to 1 / z.
  const double gain = r > 0 ? bend(parameters_.k.data(), theta) / r : 1 / p.z();
  return Eigen::Vector2d(parameters_.fx_px * gain * p.x() + parameters_.cx_px,
                         parameters_.fy_px * gain * p.y() + parameters_.cy_px);
}

std::optional<Eigen::Vector3d> FisheyeModel::unproject(const Eigen::Vector2d& px) const {
  const Eigen::Vector2d bent((px.x() - parameters_.cx_px) / parameters_.fx_px,
                             (px.y() - parameters_.cy_px) / parameters_.fy_px);
  const double target = bent.norm();
  if (!(target <= rim_)) return std::nullopt;
  if (target == 0) return Eigen::Vector3d::UnitZ();
  // The mapping grows over the domain: Newton steps, kept within bounds by bisection.
  double low = 0, high = domain_rad_, theta = std::min(target, domain_rad_);
  for (int i = 0; i < 100; ++i) {
    const double error = bend(parameters_.k.data(), theta) - target;
    (error > 0 ? high : low) = theta;
    const double newton = theta - error / bend_slope(parameters_.k.data(), theta);
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - theta) < 1e-15) break;
    theta = next;
  }
  const Eigen::Vector2d across = std::sin(theta) / target * bent;
  return Eigen::Vector3d(across.x(), across.y(), std::cos(theta));
}

Eigen::Matrix<double, 2, 3> FisheyeModel::jacobian(const Eigen::Vector3d& p) const {
  const double r2 = p.x() * p.x() + p.y() * p.y(), r = std::sqrt(r2);
  Eigen::Matrix<double, 2, 3> j;
  const Eigen::Vector2d focal(parameters_.fx_px, parameters_.fy_px);
  constexpr double kOnAxis = 1e-9;
  if (r < kOnAxis * std::abs(p.z())) {
    j << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
    return focal.asDiagonal() * j;
  }
  const double theta = std::atan2(r, p.z());
  const double gain = bend(parameters_.k.data(), theta) / r;
  const double n2 = r2 + p.z() * p.z();
  const double slope = bend_slope(parameters_.k.data(), theta);
  // d gain / d r and d gain / d z through theta = atan2(r, z).
  const double gain_r = (slope * p.z() / n2 - gain) / r, gain_z = -slope / n2;
  const Eigen::Vector2d xy = p.head<2>();
  j.leftCols<2>() = gain * Eigen::Matrix2d::Identity() + gain_r / r * xy * xy.transpose();
  j.col(2) = gain_z * xy;
  return focal.asDiagonal() * j;
}

Result<void> validate(const FisheyeModel& camera) {
  const auto& p = camera.parameters();
  if (p.size_px.empty() || p.size_px.width > 16384 || p.size_px.height > 16384)
    return bad_lens("the picture size must lie in 1..16384 pixels");
  for (double value : {p.fx_px, p.fy_px, p.cx_px, p.cy_px, p.k[0], p.k[1], p.k[2], p.k[3]})
    if (!std::isfinite(value)) return bad_lens("fx, fy, cx, cy and k1 to k4 must be finite");
  if (!(p.fx_px > 0) || !(p.fy_px > 0)) return bad_lens("fx and fy must be positive");
  if (p.max_angle_rad && !(*p.max_angle_rad > 0 && *p.max_angle_rad <= M_PI))
    return bad_lens("the largest angle must lie between 0 and pi rad");
  return check_fold(camera);
}

}  // namespace mixrig::geometry
