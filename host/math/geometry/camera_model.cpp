// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/camera_model.h"

#include <cmath>
#include <limits>
#include <string>

#include "host/math/geometry/lens_equations.h"

namespace mixrig::geometry {
namespace {

/// d (r gain(r2)) / dr: the mapping is one-to-one while this is positive.
double radial_slope(const Lens::Coefficients& d, double r2) {
  const Radial at = radial(d.data(), r2);
  return at.gain + 2 * r2 * at.derivative;
}

Eigen::Vector2d distort_unchecked(const Lens::Coefficients& d, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm();
  const double gain = radial(d.data(), r2).gain;
  const double xy = p.x() * p.y();
  return {p.x() * gain + 2 * d[2] * xy + d[3] * (r2 + 2 * p.x() * p.x()),
          p.y() * gain + d[2] * (r2 + 2 * p.y() * p.y()) + 2 * d[3] * xy};
}

/// The largest r2 up to which the radial mapping grows; infinity for none.
double radial_limit_r2(const Lens::Coefficients& distortion) {
  // Stepping in r out to 84 degrees off axis finds the first fold; bisection refines it.
  constexpr double kStep = 0.01, kMax = 10.0;
  double good = 0.0;
  for (double r = kStep; r < kMax; r += kStep) {
    const double slope = radial_slope(distortion, r * r);
    if (slope > 0 && std::isfinite(slope) && radial(distortion.data(), r * r).gain > 0) {
      good = r;
      continue;
    }
    double low = good, high = r;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (radial_slope(distortion, middle * middle) > 0 ? low : high) = middle;
    }
    return low * low;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

Lens::Lens(const Coefficients& coefficients)
    : coefficients_(coefficients),
      is_ideal_(coefficients == Coefficients{}),
      domain_r2_(is_ideal_ ? std::numeric_limits<double>::infinity()
                           : radial_limit_r2(coefficients)) {}

std::optional<Eigen::Vector2d> Lens::distort(const Eigen::Vector2d& ideal) const {
  if (is_ideal_) return ideal;
  if (!(ideal.squaredNorm() <= domain_r2_)) return std::nullopt;
  return distort_unchecked(coefficients_, ideal);
}

Eigen::Matrix2d Lens::jacobian(const Eigen::Vector2d& p) const {
  const double x = p.x(), y = p.y(), r2 = p.squaredNorm();
  const Radial at = radial(coefficients_.data(), r2);
  const double p1 = coefficients_[2], p2 = coefficients_[3];
  Eigen::Matrix2d j;
  j(0, 0) = at.gain + 2 * x * x * at.derivative + 2 * p1 * y + 6 * p2 * x;
  j(0, 1) = 2 * x * y * at.derivative + 2 * p1 * x + 2 * p2 * y;
  j(1, 0) = j(0, 1);
  j(1, 1) = at.gain + 2 * y * y * at.derivative + 6 * p1 * y + 2 * p2 * x;
  return j;
}

std::optional<Eigen::Vector2d> Lens::undistort(const Eigen::Vector2d& distorted) const {
  if (is_ideal_) return distorted;
  Eigen::Vector2d ideal = distorted;
  if (ideal.squaredNorm() > domain_r2_) ideal *= 0.9 * std::sqrt(domain_r2_ / ideal.squaredNorm());
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d residual = distort_unchecked(coefficients_, ideal) - distorted;
    if (residual.squaredNorm() < 1e-24) return ideal;
    const Eigen::Matrix2d j = jacobian(ideal);
    if (!(std::abs(j.determinant()) > 1e-12)) return std::nullopt;
    Eigen::Vector2d next = ideal - j.inverse() * residual;
    // A step past the fold would find the mirrored solution: stay inside.
    while (next.squaredNorm() > domain_r2_ && (next - ideal).squaredNorm() > 1e-24)
      next = 0.5 * (next + ideal);
    ideal = next;
  }
  const bool solved = (distort_unchecked(coefficients_, ideal) - distorted).squaredNorm() < 1e-18;
  return solved ? std::optional(ideal) : std::nullopt;
}

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& p) const {
  if (!(p.z() > 0)) return std::nullopt;
  const auto d = lens.distort({p.x() / p.z(), p.y() / p.z()});
  if (!d) return std::nullopt;
  return Eigen::Vector2d(pinhole.fx_px * d->x() + pinhole.cx_px,
                         pinhole.fy_px * d->y() + pinhole.cy_px);
}

std::optional<Eigen::Vector2d> CameraModel::unproject(const Eigen::Vector2d& px) const {
  return lens.undistort(pinhole.unproject(px));
}

Result<void> validate(const CameraModel& camera) {
  const Pinhole& p = camera.pinhole;
  const auto bad = [](const std::string& what) { return Error{ErrorCode::kData, what}; };
  if (p.size_px.empty() || p.size_px.width > 16384 || p.size_px.height > 16384)
    return bad("the picture size must lie in 1..16384 pixels");
  for (double value : {p.fx_px, p.fy_px, p.cx_px, p.cy_px})
    if (!std::isfinite(value)) return bad("fx, fy, cx and cy must be finite");
  if (!(p.fx_px > 0) || !(p.fy_px > 0))
    return bad("fx and fy must be positive (a singular camera matrix)");
  for (double k : camera.lens.coefficients())
    if (!std::isfinite(k)) return bad("a distortion coefficient is not finite");
  if (camera.lens.is_ideal()) return {};
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(p.size_px.width - 1, 0),
        Eigen::Vector2d(0, p.size_px.height - 1),
        Eigen::Vector2d(p.size_px.width - 1, p.size_px.height - 1)})
    if (!camera.unproject(corner))
      return bad("the lens folds inside the picture: check the distortion coefficients");
  return {};
}

Pinhole ideal_view(const CameraModel& camera) {
  Pinhole view = camera.pinhole;
  if (camera.lens.is_ideal()) return view;
  const double width = view.size_px.width - 1, height = view.size_px.height - 1;
  const auto inside = [&](double zoom) {
    for (int i = 0; i <= 64; ++i) {
      const double t = i / 64.0;
      for (const Eigen::Vector2d& px :
           {Eigen::Vector2d(t * width, 0), Eigen::Vector2d(t * width, height),
            Eigen::Vector2d(0, t * height), Eigen::Vector2d(width, t * height)}) {
        const Eigen::Vector2d ray =
            (px - Eigen::Vector2d(view.cx_px, view.cy_px))
                .cwiseQuotient(zoom * Eigen::Vector2d(view.fx_px, view.fy_px));
        const auto at = camera.project({ray.x(), ray.y(), 1.0});
        if (!at || at->x() < 0 || at->y() < 0 || at->x() > width || at->y() > height) return false;
      }
    }
    return true;
  };
  double low = 1.0, high = 1.0;
  if (!inside(1.0)) {
    while (!inside(high) && high < 8.0) high *= 1.25;
    for (int i = 0; i < 30; ++i) (inside(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  }
  view.fx_px *= high;
  view.fy_px *= high;
  return view;
}

}  // namespace mixrig::geometry
